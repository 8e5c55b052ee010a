#include "geometry/io/e57/scan_file.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>

#include "geometry/byte_values.h"
#include "geometry/io/e57/layout.h"
#include "geometry/io/e57/pages.h"

namespace skycap::geometry::e57 {
namespace {

using std::string_view;

std::string format_number(double number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}

std::string escaped(string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else {
      result += c;
    }
  }
  return result;
}

std::string element(string_view name, string_view type, string_view content) {
  return std::string("<")
             .append(name)
             .append(" type=\"")
             .append(type)
             .append("\">")
             .append(content) +
         std::string("</").append(name).append(">\n");
}

std::string element(const std::string& name, double number) {
  return element(name, "Float", format_number(number));
}

/// Returns a GUID of 16 bytes derived from a text with two FNV-1a hashes.
std::string make_guid(string_view text) {
  std::array<std::uint8_t, 16> bytes{};
  constexpr std::uint64_t beginning = 0xCBF29CE484222325, prime = 0x100000001B3;
  for (std::size_t half = 0; half < 2; ++half) {
    std::uint64_t hash = beginning + half;
    for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * prime;
    for (std::size_t i = 0; i < 8; ++i) {
      bytes[8 * half + i] = static_cast<std::uint8_t>(hash >> 8 * i & 0xFF);
    }
  }
  bytes[6] =
      static_cast<std::uint8_t>((bytes[6] & 0x0F) | 0x80);  // RFC 9562, section 5.8: version 8
  bytes[8] = static_cast<std::uint8_t>((bytes[8] & 0x3F) | 0x80);
  std::string result = "{";
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    constexpr string_view digits = "0123456789ABCDEF";
    if (i == 4 || i == 6 || i == 8 || i == 10) result += '-';
    result += digits[bytes[i] >> 4];
    result += digits[bytes[i] & 15];
  }
  return result + "}";
}

std::string field_text(const Field& field) {
  const bool is_float =
      field.coding == Coding::single_precision || field.coding == Coding::double_precision;
  std::string text = "<" + field.name + " type=\"";
  if (is_float) {
    text += "Float\" precision=\"";
    text += field.coding == Coding::single_precision ? "single" : "double";
  } else {
    text += field.coding == Coding::integer ? "Integer" : "ScaledInteger";
    text += "\" minimum=\"" + std::to_string(field.minimum) + "\" maximum=\"" +
            std::to_string(field.maximum);
  }
  if (field.coding == Coding::scaled_integer) {
    text +=
        "\" scale=\"" + format_number(field.scale) + "\" offset=\"" + format_number(field.offset);
  }
  return text + "\"/>\n";
}

bool has_field(const WrittenScan& scan, string_view name) {
  return std::ranges::find(scan.fields, name, &Field::name) != scan.fields.end();
}

/// Returns the XML of the value limits of the scan.
std::string limits_text(const WrittenScan& scan) {
  std::string text;
  if (!scan.bounds.isEmpty()) {
    constexpr std::array axes{"x", "y", "z"};
    std::string box;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name = axes[static_cast<std::size_t>(axis)];
      box += element(name + "Minimum", scan.bounds.min()[axis]);
      box += element(name + "Maximum", scan.bounds.max()[axis]);
    }
    text += element("cartesianBounds", "Structure", "\n" + box);
  }
  if (has_field(scan, "intensity")) {
    text += element("intensityLimits", "Structure",
                    "\n" + element("intensityMinimum", 0.0) + element("intensityMaximum", 1.0));
  }
  if (has_field(scan, "colorRed")) {
    std::string limits = "\n";
    for (const std::string colour : {"Red", "Green", "Blue"}) {
      limits += element("color" + colour + "Minimum", "Integer", "0");
      limits += element("color" + colour + "Maximum", "Integer", "255");
    }
    text += element("colorLimits", "Structure", limits);
  }
  return text;
}

/// Returns the physical offset of the section header of the records, which ends the beginning of
/// the file.
std::uint64_t section_offset(std::uint64_t pages) {
  return (pages - 1) * page_size + page_content - section::size;
}

std::string scan_text(const WrittenScan& scan, std::uint64_t pages) {
  std::string prototype = "\n";
  for (const Field& field : scan.fields) prototype += field_text(field);
  std::string text = "\n" + limits_text(scan);
  if (!scan.sensor.empty()) text += element("sensorModel", "String", escaped(scan.sensor));
  text += "<points type=\"CompressedVector\" fileOffset=\"" +
          std::to_string(section_offset(pages)) + "\" recordCount=\"" +
          std::to_string(scan.records) + "\">\n" + element("prototype", "Structure", prototype) +
          "<codecs type=\"Vector\" allowHeterogeneousChildren=\"1\"/>\n</points>\n";
  const std::string identifier = make_guid(text + std::to_string(scan.checksum));
  return element("vectorChild", "Structure", "\n" + element("guid", "String", identifier) + text);
}

std::string make_description(const WrittenScan& scan, std::uint64_t pages) {
  std::string text = element("formatName", "String", "ASTM E57 3D Imaging Data File");
  text += element("versionMajor", "Integer", "1") + element("versionMinor", "Integer", "0") +
          element("e57LibraryVersion", "String", "Skycap");
  if (!scan.reference_system.empty()) {
    text += element("coordinateMetadata", "String", escaped(scan.reference_system));
  }
  text += "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n" + scan_text(scan, pages) +
          "</data3D>\n<images2D type=\"Vector\" allowHeterogeneousChildren=\"1\"/>\n";
  std::string root =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
      "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\"";
  if (has_field(scan, "nor:normalX")) {
    root += " xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\"";
  }
  return root + ">\n" + element("guid", "String", make_guid(text)) + text + "</e57Root>\n";
}

/// Computed for the longest numbers that the description can contain.
std::uint64_t count_head_pages(WrittenScan scan) {
  constexpr double long_number = -2.2250738585072014e-308;
  scan.bounds = Eigen::AlignedBox3d(Eigen::Vector3d::Constant(long_number));
  scan.records = std::numeric_limits<std::uint64_t>::max();
  constexpr std::uint64_t many_pages = std::uint64_t{1} << 40;
  const std::size_t size = header::size + make_description(scan, many_pages).size() + section::size;
  return (size + page_content - 1) / page_content;
}

}  // namespace

std::string make_file_head(const WrittenScan& scan) {
  const std::uint64_t pages = count_head_pages(scan);
  const std::string xml = make_description(scan, pages);
  std::string content(pages * page_content, '\0');
  char* const bytes = content.data();
  content.replace(0, 8, "ASTM-E57");
  put_value(bytes, header::major, std::uint32_t{1});
  const std::uint64_t record_pages = (scan.packets_size + page_content - 1) / page_content;
  put_value(bytes, header::file_size, (pages + record_pages) * page_size);
  put_value(bytes, header::description, std::uint64_t{header::size});
  put_value(bytes, header::description_size, std::uint64_t{xml.size()});
  put_value(bytes, header::page_size, std::uint64_t{page_size});
  content.replace(header::size, xml.size(), xml);
  char* const head = bytes + content.size() - section::size;
  head[section::kind] = section::compressed_vector;
  put_value(head, section::length, std::uint64_t{section::size + scan.packets_size});
  // Without records, there is no packet to refer to.
  put_value(head, section::data, scan.records > 0 ? pages * page_size : section_offset(pages));
  return sealed(content);
}

std::string make_packets(std::span<const Field> fields, std::span<const std::string> values) {
  assert(fields.size() == values.size() && !fields.empty());
  std::size_t record_size = 0;  // [bytes]
  for (const Field& field : fields) record_size += field.bits() / 8;
  const std::size_t head = packet::lengths + 2 * fields.size();
  const std::size_t max = (packet::largest_size - packet::min_size - head) / record_size;
  const std::size_t count = values[0].size() / (fields[0].bits() / 8);
  std::string content;
  for (std::size_t begin = 0; begin < count; begin += max) {
    const std::size_t records = std::min(max, count - begin);
    std::string data(head, '\0');
    data[packet::kind] = packet::data;
    put_value(data.data(), packet::streams, static_cast<std::uint16_t>(fields.size()));
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const std::size_t size = fields[i].bits() / 8;
      put_value(data.data(), packet::lengths + 2 * i, static_cast<std::uint16_t>(records * size));
      data.append(values[i], begin * size, records * size);
    }
    data.resize((data.size() + packet::min_size - 1) / packet::min_size * packet::min_size);
    put_value(data.data(), packet::size_less_one, static_cast<std::uint16_t>(data.size() - 1));
    content += data;
  }
  return content;
}

}  // namespace skycap::geometry::e57
