// Reader of PCD without PCL, because PCL's io library loads 67 other libraries, including VTK, at
// program start.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "geometry/io/cloud_parsers.h"
#include "geometry/io/text/text_scanner.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

struct PcdField {
  std::string name;
  std::size_t size = 0, count = 1;
  char type = 'F';         // F, I or U
  std::size_t before = 0;  // bytes of a point before this field
  std::size_t column = 0;  // words of a line before this field
};

enum class PcdData { text, binary, compressed };

struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t points = 0, point_size = 0, end = 0;  // `end`: offset of the data
  std::size_t first_line = 1;                       // first line of the data, for messages
  PcdData data = PcdData::text;
};

std::vector<std::string> split_line(TextScanner& scanner) {
  std::vector<std::string> words;
  while (const auto word = scanner.word_in_line()) words.emplace_back(*word);
  return words;
}

// Calls `set` for each field with its word. The number of words must equal the number of fields.
template <typename Set>
void for_each_field(TextScanner& scanner, PcdHeader& header, const std::string& key, Set set) {
  const std::vector<std::string> words = split_line(scanner);
  if (words.size() != header.fields.size()) {
    scanner.fail(key + " has " + std::to_string(words.size()) + " entries for " +
                 std::to_string(header.fields.size()) + " fields");
  }
  for (std::size_t i = 0; i < words.size(); ++i) set(header.fields[i], words[i]);
}

void lay_out(TextScanner& scanner, PcdHeader& header) {
  std::size_t column = 0;
  for (PcdField& field : header.fields) {
    const bool is_real = field.type == 'F' && (field.size == 4 || field.size == 8);
    const bool is_whole =
        (field.type == 'I' || field.type == 'U') &&
        (field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8);
    if ((!is_real && !is_whole) || field.count > 1'000'000) {
      scanner.fail("the field '" + field.name +
                   "' has a combination of SIZE, TYPE and COUNT that PCD does not support");
    }
    field.before = header.point_size;
    field.column = column;
    header.point_size += field.size * field.count;
    column += field.count;
  }
}

/// Advances to the data after the DATA line. Bytes after a bare \r belong to the data.
void go_to_data(TextScanner& scanner, std::string_view bytes, PcdHeader& header) {
  const std::size_t end = bytes.size() - scanner.remaining();
  scanner.next_line();
  header.end = bytes.size() - scanner.remaining();
  header.first_line = scanner.line();
  const std::size_t first_end = bytes.find_first_of("\r\n");
  const bool has_bare_returns = first_end != std::string_view::npos && bytes[first_end] == '\r' &&
                                !bytes.substr(first_end).starts_with("\r\n");
  const bool is_cut = bytes.substr(end, header.end - end).ends_with("\r\n");
  if (has_bare_returns && is_cut && header.data != PcdData::text) --header.end;
}

PcdHeader parse_header(const fs::path& path, const std::string& name, std::string_view bytes) {
  TextScanner scanner(name, bytes);
  PcdHeader header;
  std::optional<std::size_t> width, height, points;
  do {
    const auto key_word = scanner.word_in_line();
    if (!key_word || key_word->starts_with('#')) continue;
    // Version 0.5 uses COLUMNS instead of FIELDS.
    const std::string key = *key_word == "COLUMNS" ? "FIELDS" : std::string(*key_word);
    const auto count = [&](const std::string& word) {
      return scanner.number<std::size_t>(std::string_view(word), "a number of " + key);
    };
    if (key == "FIELDS") {
      for (const std::string& field : split_line(scanner)) header.fields.push_back({field});
    } else if (key == "SIZE") {
      for_each_field(scanner, header, key,
                     [&](auto& field, auto& word) { field.size = count(word); });
    } else if (key == "TYPE") {
      for_each_field(scanner, header, key, [](auto& field, auto& word) { field.type = word[0]; });
    } else if (key == "COUNT") {
      for_each_field(scanner, header, key,
                     [&](auto& field, auto& word) { field.count = count(word); });
    } else if (key == "WIDTH" || key == "HEIGHT" || key == "POINTS") {
      const auto number = scanner.number<std::uint32_t>(scanner.word_in_line(), "a number");
      (key == "WIDTH" ? width : key == "HEIGHT" ? height : points) = number;
    } else if (key == "DATA") {
      const std::string_view as_written = scanner.word_in_line().value_or("");
      const std::string kind = lower_case(as_written);
      if (kind != "ascii" && kind != "binary" && kind != "binary_compressed") {
        scanner.fail("DATA is '" + std::string(as_written) +
                     "'; it must be ascii, binary or binary_compressed");
      }
      header.data = kind == "ascii"    ? PcdData::text
                    : kind == "binary" ? PcdData::binary
                                       : PcdData::compressed;
      lay_out(scanner, header);
      go_to_data(scanner, bytes, header);
      if (!points && !(width && height)) {
        fail_cloud(path, "has neither POINTS nor WIDTH and HEIGHT in its header");
      }
      header.points = points ? *points : *width * *height;
      return header;
    } else if (key != "VERSION" && key != "VIEWPOINT") {
      scanner.fail("'" + key.substr(0, 40) + "' is not a PCD header keyword");
    }
  } while (scanner.next_line());
  fail_cloud(path, "is not a PCD file: its header has no DATA");
}

// LZF of M. Lehmann: literal runs, and copies of up to 264 bytes with offsets of up to 8 KiB.
std::string decompressed(const fs::path& path, std::string_view from, std::size_t size) {
  const auto damaged = [&]() { fail_cloud(path, "contains damaged compressed data"); };
  constexpr std::size_t max_expansion = 132;  // a copy of 264 bytes needs at least two bytes
  if (size / max_expansion > from.size()) damaged();
  std::string to;
  to.reserve(size);
  std::size_t i = 0;
  const auto next = [&]() -> std::size_t {
    if (i >= from.size()) damaged();
    return static_cast<std::uint8_t>(from[i++]);
  };
  while (i < from.size()) {
    const std::size_t control = next();
    if (control < 32) {
      if (from.size() - i < control + 1) damaged();
      to.append(from.substr(i, control + 1));
      i += control + 1;
    } else {
      std::size_t length = control >> 5;
      if (length == 7) length += next();
      const std::size_t back = ((control & 31) << 8) + next() + 1;
      if (back > to.size()) damaged();
      for (std::size_t copied = 0; copied < length + 2; ++copied) to += to[to.size() - back];
    }
    if (to.size() > size) damaged();
  }
  if (to.size() != size) damaged();
  return to;
}

double number_at(std::string_view bytes, std::size_t offset, const PcdField& field) {
  static_assert(std::endian::native == std::endian::little, "PCD files are little-endian");
  const auto as = [&](auto value) {
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return static_cast<double>(value);
  };
  if (field.type == 'F') return field.size == 4 ? as(0.0F) : as(0.0);
  const bool is_signed = field.type == 'I';
  switch (field.size) {
    case 1:
      return is_signed ? as(std::int8_t{}) : as(std::uint8_t{});
    case 2:
      return is_signed ? as(std::int16_t{}) : as(std::uint16_t{});
    case 4:
      return is_signed ? as(std::int32_t{}) : as(std::uint32_t{});
    default:
      return is_signed ? as(std::int64_t{}) : as(std::uint64_t{});
  }
}

/// Files of PCL contain colours as the bits of a real number, which may be NaN.
bool is_packed_colour(const PcdField& field) {
  return field.size == 4 && (field.name == "rgb" || field.name == "rgba");
}

double packed_colour_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t packed = 0;
  std::memcpy(&packed, bytes.data() + offset, sizeof packed);
  return packed;
}

class FieldReader {
 public:
  FieldReader(const fs::path& path, const PcdHeader& header, const SelectFields& select,
              const FieldValues& callback)
      : path_(path), header_(header), callback_(callback) {
    std::vector<std::string> names;
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < header.fields.size(); ++i) {
      if (header.fields[i].count != 1) continue;
      names.push_back(header.fields[i].name);
      indices.push_back(i);
    }
    for (const std::size_t i : select(names)) fields_.push_back(header.fields[indices[i]]);
    values_.resize(fields_.size());
  }

  void read_text(const std::string& name, std::string_view text) {
    TextScanner scanner(name, text, header_.first_line);
    std::size_t point = 0;
    do {
      const std::vector<std::string> words = split_line(scanner);
      if (words.empty()) continue;
      for (std::size_t i = 0; i < fields_.size(); ++i) {
        const std::size_t column = fields_[i].column;
        values_[i] = scanner.number<double>(
            column < words.size() ? std::optional<std::string_view>(words[column]) : std::nullopt,
            fields_[i].name);
        if (is_packed_colour(fields_[i]) && fields_[i].type == 'F') {
          values_[i] = std::bit_cast<std::uint32_t>(static_cast<float>(values_[i]));
        }
      }
      add(point++);
      require_few_points(path_, point);
    } while (scanner.next_line());
    require(point);
  }

  // Reads the data by point or by field.
  void read_binary(std::string_view bytes, bool is_by_field) {
    require(bytes.size() / std::max<std::size_t>(1, header_.point_size));
    require_few_points(path_, header_.points);
    for (std::size_t point = 0; point < header_.points; ++point) {
      for (std::size_t i = 0; i < fields_.size(); ++i) {
        const PcdField& field = fields_[i];
        const std::size_t offset = is_by_field ? field.before * header_.points + point * field.size
                                               : point * header_.point_size + field.before;
        values_[i] = is_packed_colour(field) ? packed_colour_at(bytes, offset)
                                             : number_at(bytes, offset, field);
      }
      add(point);
    }
  }

 private:
  void require(std::size_t points) const {
    if (points >= header_.points) return;
    fail_cloud(path_, "ends after " + std::to_string(points) + " of its " +
                          std::to_string(header_.points) + " points");
  }

  void add(std::size_t point) {
    if (point >= header_.points) return;
    callback_(values_);
  }

  const fs::path& path_;
  const PcdHeader& header_;
  const FieldValues& callback_;
  std::vector<PcdField> fields_;
  std::vector<double> values_;
};

}  // namespace

void read_pcd_fields(const fs::path& path, std::string_view bytes, const SelectFields& select,
                     const FieldValues& callback) {
  const std::string name = path.string();
  const PcdHeader header = parse_header(path, name, bytes);
  const std::string_view data = bytes.substr(header.end);
  FieldReader reader(path, header, select, callback);
  if (header.data == PcdData::text) {
    reader.read_text(name, data);
  } else if (header.data == PcdData::binary) {
    reader.read_binary(data, false);
  } else {
    std::array<std::uint32_t, 2> sizes{};  // compressed and decompressed
    if (data.size() < sizeof sizes) fail_cloud(path, "ends before its compressed data");
    std::memcpy(sizes.data(), data.data(), sizeof sizes);
    if (data.size() - sizeof sizes < sizes[0]) fail_cloud(path, "ends within its compressed data");
    reader.read_binary(decompressed(path, data.substr(sizeof sizes, sizes[0]), sizes[1]), true);
  }
}

AttributedCloud parse_pcd_cloud(const fs::path& path, std::string_view bytes) {
  AttributedCloud cloud;
  bool has_normals = false;
  std::size_t point = 0;
  const auto select = [&](std::span<const std::string> names) {
    std::vector<std::size_t> indices;
    for (const std::string_view name : {"x", "y", "z", "normal_x", "normal_y", "normal_z"}) {
      const auto field = std::ranges::find(names, name);
      if (field != names.end()) {
        indices.push_back(static_cast<std::size_t>(field - names.begin()));
      } else if (indices.size() < 3) {
        fail_cloud(path, "must have the fields x, y and z");
      }
    }
    has_normals = indices.size() == 6;
    if (!has_normals) indices.resize(3);
    return indices;
  };
  read_pcd_fields(path, bytes, select, [&](std::span<const double> values) {
    const Eigen::Vector3d position(values[0], values[1], values[2]);
    const std::size_t index = point++;
    if (!position.allFinite()) {
      ++cloud.skipped;
      return;
    }
    cloud.positions.push_back(cloud_position(path, index, values[0], values[1], values[2]));
    if (!has_normals) return;
    cloud.normals.push_back(Eigen::Vector3d(values[3], values[4], values[5]).cast<float>());
  });
  return cloud;
}

}  // namespace skycap::geometry
