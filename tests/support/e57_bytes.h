/// E57 files assembled bit by bit. This code is independent of the tested reader.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::testing_support {

/// Computes CRC-32C according to its definition, one bit at a time.
inline std::uint32_t slow_crc32c(std::string_view bytes) {
  std::uint32_t sum = 0xFFFFFFFF;
  for (const char byte : bytes) {
    sum ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 1) != 0 ? sum >> 1 ^ 0x82F63B78 : sum >> 1;
  }
  return ~sum;
}

inline constexpr std::size_t e57_page = 1024, e57_content = 1020;

/// Returns pages with checksums. The last page is padded with zeros.
inline std::string e57_pages(std::string content) {
  content.resize((content.size() + e57_content - 1) / e57_content * e57_content);
  std::string pages;
  for (std::size_t begin = 0; begin < content.size(); begin += e57_content) {
    const std::string page = content.substr(begin, e57_content);
    const std::uint32_t sum = slow_crc32c(page);
    pages += page;
    for (const int shift : {24, 16, 8, 0}) pages += static_cast<char>(sum >> shift & 0xFF);
  }
  return pages;
}

/// Returns the content of the pages without the checksums.
inline std::string extract_e57_content(std::string_view pages) {
  std::string content;
  for (std::size_t begin = 0; begin < pages.size(); begin += e57_page) {
    content += pages.substr(begin, e57_content);
  }
  return content;
}

inline std::uint64_t e57_physical(std::uint64_t logical) {
  return logical / e57_content * e57_page + logical % e57_content;
}

template <typename Value>
void append_little_endian(std::string& bytes, Value value) {
  for (std::size_t i = 0; i < sizeof value; ++i) bytes += static_cast<char>(value >> 8 * i & 0xFF);
}

/// A record field: its XML element and all its bits.
struct E57Stream {
  std::string xml;
  std::vector<bool> bits;

  void add(std::uint64_t value, unsigned count) {
    for (unsigned bit = 0; bit < count; ++bit) bits.push_back((value >> bit & 1) != 0);
  }
  std::string bytes() const {
    std::string result((bits.size() + 7) / 8, '\0');
    for (std::size_t i = 0; i < bits.size(); ++i) {
      if (bits[i]) result[i / 8] = static_cast<char>(result[i / 8] | 1 << i % 8);
    }
    return result;
  }
};

inline unsigned count_interval_bits(std::int64_t minimum, std::int64_t maximum) {
  unsigned bits = 0;
  auto span = static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(minimum);
  for (; span != 0; span >>= 1) ++bits;
  return bits;
}

/// Returns a field of integers. `more` contains further XML attributes, such as a scale.
inline E57Stream e57_integers(const std::string& name, std::int64_t minimum, std::int64_t maximum,
                              const std::vector<std::int64_t>& values,
                              const std::string& type = "Integer", const std::string& more = "") {
  E57Stream stream{"<" + name + " type=\"" + type + "\" minimum=\"" + std::to_string(minimum) +
                       "\" maximum=\"" + std::to_string(maximum) + "\" " + more + "/>",
                   {}};
  for (const std::int64_t value : values) {
    stream.add(static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(minimum),
               count_interval_bits(minimum, maximum));
  }
  return stream;
}

inline E57Stream e57_doubles(const std::string& name, const std::vector<double>& values) {
  E57Stream stream{"<" + name + " type=\"Float\"/>", {}};
  for (const double value : values) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    stream.add(bits, 64);
  }
  return stream;
}

inline E57Stream e57_singles(const std::string& name, const std::vector<float>& values) {
  E57Stream stream{"<" + name + " type=\"Float\" precision=\"single\"/>", {}};
  for (const float value : values) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    stream.add(bits, 32);
  }
  return stream;
}

struct E57Scan {
  std::vector<E57Stream> streams;
  std::uint64_t records = 0;  ///< as declared in the file
  std::string more = {};      ///< additional XML: a pose, colour limits
  std::size_t packets = 1;    ///< number of packets that each stream is divided into, at any bit
  bool has_others = false;    ///< adds an index packet and an empty packet before each of them
};

/// Returns the section header and the packets, for a section that starts at this logical offset.
inline std::string e57_section(const E57Scan& scan, std::uint64_t section_begin) {
  std::string packets;
  std::vector<std::string> columns;
  for (const E57Stream& stream : scan.streams) columns.push_back(stream.bytes());
  for (std::size_t part = 0; part < scan.packets; ++part) {
    if (scan.has_others) {
      packets += std::string("\0\0\x1F\0\x01\0\0\0", 8) + std::string(24, '\0');
      packets += std::string("\x02\0\x07\0", 4) + std::string(4, '\0');
    }
    std::string lengths, streams;
    for (const std::string& bytes : columns) {
      const std::size_t begin = bytes.size() * part / scan.packets,
                        end = bytes.size() * (part + 1) / scan.packets;
      append_little_endian(lengths, static_cast<std::uint16_t>(end - begin));
      streams += bytes.substr(begin, end - begin);
    }
    std::string body = lengths + streams;
    while ((6 + body.size()) % 4 != 0) body += '\0';
    packets += std::string("\x01\0", 2);
    append_little_endian(packets, static_cast<std::uint16_t>(6 + body.size() - 1));
    append_little_endian(packets, static_cast<std::uint16_t>(scan.streams.size()));
    packets += body;
  }
  std::string section("\x01\0\0\0\0\0\0\0", 8);
  append_little_endian(section, std::uint64_t{32 + packets.size()});
  append_little_endian(section, e57_physical(section_begin + 32));
  append_little_endian(section, std::uint64_t{0});
  return section + packets;
}

/// Returns the file header for the following logical content with the XML at its end.
inline std::string e57_header(std::uint64_t content_size, std::uint64_t xml_size) {
  std::string header = "ASTM-E57";
  append_little_endian(header, std::uint32_t{1});
  append_little_endian(header, std::uint32_t{0});
  append_little_endian(header,
                       std::uint64_t{(content_size + e57_content - 1) / e57_content * e57_page});
  append_little_endian(header, e57_physical(content_size - xml_size));
  append_little_endian(header, xml_size);
  append_little_endian(header, std::uint64_t{e57_page});
  return header;
}

/// Returns a file with the XML after the content, which has room for the header.
inline std::string e57_with_xml(std::string content, const std::string& xml) {
  content += xml;
  content.replace(0, 48, e57_header(content.size(), xml.size()));
  return e57_pages(content);
}

inline std::string make_e57(const std::vector<E57Scan>& scans, const std::string& more = "") {
  std::string content(48, '\0');
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
      "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" xmlns:nor=\"normals\">\n"
      "<formatName type=\"String\"><![CDATA[ASTM E57 3D Imaging Data File]]></formatName>\n" +
      more + "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n";
  for (const E57Scan& scan : scans) {
    xml += "<vectorChild type=\"Structure\">" + scan.more +
           "<points type=\"CompressedVector\" fileOffset=\"" +
           std::to_string(e57_physical(content.size())) + "\" recordCount=\"" +
           std::to_string(scan.records) + "\"><prototype type=\"Structure\">";
    for (const E57Stream& stream : scan.streams) xml += stream.xml;
    xml += "</prototype></points></vectorChild>\n";
    content += e57_section(scan, content.size());
  }
  return e57_with_xml(content, xml + "</data3D></e57Root>\n");
}

/// Returns a file with one scan of doubles.
inline std::string make_e57_from_points(const std::vector<std::array<double, 3>>& points,
                                        const std::string& more = "") {
  E57Scan scan;
  const char* const names[] = {"cartesianX", "cartesianY", "cartesianZ"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& point : points) values.push_back(point[axis]);
    scan.streams.push_back(e57_doubles(names[axis], values));
  }
  scan.records = points.size();
  return make_e57({scan}, more);
}

}  // namespace skycap::testing_support
