#include "geometry/io/text/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "geometry/error.h"
#include "geometry/io/text/text_scanner.h"

namespace skycap::geometry {
namespace {

static_assert(std::endian::native == std::endian::little, "binary PLY is read by copying bytes");

constexpr std::array<std::pair<std::string_view, PlyType>, 16> type_names{{
    {"char", PlyType::int8},
    {"int8", PlyType::int8},
    {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},
    {"short", PlyType::int16},
    {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},
    {"uint16", PlyType::uint16},
    {"int", PlyType::int32},
    {"int32", PlyType::int32},
    {"uint", PlyType::uint32},
    {"uint32", PlyType::uint32},
    {"float", PlyType::float32},
    {"float32", PlyType::float32},
    {"double", PlyType::float64},
    {"float64", PlyType::float64},
}};

PlyType parse_type(const TextScanner& scanner, std::optional<std::string_view> word) {
  for (const auto& [name, type] : type_names) {
    if (word == name) return type;
  }
  scanner.fail("the property type '" + std::string(word.value_or("")) +
               "' is unknown; it must be one of char, uchar, short, ushort, int, uint, float, "
               "double, or int8 ... float64");
}

std::size_t compute_size(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      return 8;
  }
  return 8;
}

bool is_integer(PlyType type) { return type != PlyType::float32 && type != PlyType::float64; }

template <typename Value>
double load(const char* bytes, bool swap) {
  std::array<char, sizeof(Value)> raw;
  std::memcpy(raw.data(), bytes, raw.size());
  if (swap) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<Value>(raw));
}

/// Calls `visit` with a std::type_identity of the value type.
template <typename Visit>
auto with_type(PlyType type, const Visit& visit) {
  switch (type) {
    case PlyType::int8:
      return visit(std::type_identity<std::int8_t>());
    case PlyType::uint8:
      return visit(std::type_identity<std::uint8_t>());
    case PlyType::int16:
      return visit(std::type_identity<std::int16_t>());
    case PlyType::uint16:
      return visit(std::type_identity<std::uint16_t>());
    case PlyType::int32:
      return visit(std::type_identity<std::int32_t>());
    case PlyType::uint32:
      return visit(std::type_identity<std::uint32_t>());
    case PlyType::float32:
      return visit(std::type_identity<float>());
    case PlyType::float64:
      break;
  }
  return visit(std::type_identity<double>());
}

double load(PlyType type, const char* bytes, bool swap) {
  return with_type(
      type, [&]<typename Value>(std::type_identity<Value>) { return load<Value>(bytes, swap); });
}

bool is_full(const PlyTable& table) { return table.list_values.size() >= longest_ply_list; }

PlyProperty parse_property(TextScanner& scanner) {
  PlyProperty property{};
  auto type = scanner.word_in_line();
  if (type == "list") {
    property.count_type = parse_type(scanner, scanner.word_in_line());
    if (!is_integer(*property.count_type)) {
      scanner.fail("the length of a list must have an integer type");
    }
    type = scanner.word_in_line();
  }
  property.type = parse_type(scanner, type);
  property.name = scanner.word_in_line().value_or("");
  return property;
}

std::string_view to_string(PlyType type) {
  return std::ranges::find(type_names, type, [](const auto& row) { return row.second; })->first;
}

}  // namespace

void PlyElement::add(PlyType type, std::initializer_list<std::string_view> names) {
  for (const std::string_view scalar : names) {
    properties.push_back({std::string(scalar), type, {}});
  }
}

std::string ply_header(std::span<const PlyElement> elements, std::string_view comment) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  if (!comment.empty()) text.append("comment ").append(comment).append("\n");
  for (const PlyElement& element : elements) {
    text += "element " + element.name + " " + std::to_string(element.count) + "\n";
    for (const PlyProperty& property : element.properties) {
      text += "property ";
      if (property.count_type) text.append("list ").append(to_string(*property.count_type)) += ' ';
      text.append(to_string(property.type)).append(" ").append(property.name) += '\n';
    }
  }
  return text + "end_header\n";
}

std::string growing_ply_header(const PlyElement& element) {
  constexpr std::size_t max_digits = 20;  // digits of a 64-bit number
  const std::size_t digits = std::to_string(element.count).size();
  return ply_header({&element, 1}, "written by Skycap" + std::string(max_digits - digits, ' '));
}

// Column of each property of an element, or -1, and index of the list property.
struct PlyReader::PropertyIndices {
  std::vector<int> column;
  std::size_t list;
  std::size_t smallest_row;  // [bytes]
};

// Range of rows to be read.
struct PlyReader::Rows {
  const PlyElement& element;
  std::uint64_t begin, end;
};

namespace {

/// Returns whether the line 'ply' ends with a bare \r, as in old Macintosh programs.
bool ends_lines_with_return(std::string_view bytes) {
  const std::size_t end = bytes.find_first_of("\r\n");
  return end != std::string_view::npos && bytes[end] == '\r' &&
         !bytes.substr(end).starts_with("\r\n");
}

}  // namespace

PlyReader::PlyReader(std::string_view name, std::string_view bytes) : name_(name), bytes_(bytes) {
  read_header();
}

void PlyReader::fail(const std::string& what) const {
  throw Error(ErrorKind::bad_file, std::string(name_) + ": " + what);
}

void PlyReader::read_header() {
  TextScanner scanner(name_, bytes_);
  if (scanner.word_in_line() != "ply") {
    scanner.fail("the first line of a PLY file must be 'ply'");
  }
  bool has_format = false;
  while (true) {
    if (!scanner.next_line()) scanner.fail("the header ends without a line 'end_header'");
    const auto keyword = scanner.word_in_line();
    if (!keyword || keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "end_header") break;
    if (keyword == "format") {
      const auto format = scanner.word_in_line();
      if (format == "ascii") {
        format_ = Format::ascii;
      } else if (format == "binary_little_endian") {
        format_ = Format::little_endian;
      } else if (format == "binary_big_endian") {
        format_ = Format::big_endian;
      } else {
        scanner.fail("the format '" + std::string(format.value_or("")) +
                     "' is unknown; it must be ascii, binary_little_endian or binary_big_endian");
      }
      has_format = true;
    } else if (keyword == "element") {
      PlyElement element;
      element.name = scanner.word_in_line().value_or("");
      element.count = scanner.number<std::uint64_t>(scanner.word_in_line(), "a number of elements");
      elements_.push_back(std::move(element));
    } else if (keyword == "property") {
      if (elements_.empty()) scanner.fail("a property must follow the element it belongs to");
      elements_.back().properties.push_back(parse_property(scanner));
    } else {
      scanner.fail("'" + std::string(keyword->substr(0, 40)) +
                   "' is not a PLY header keyword; it must be format, element, property, comment, "
                   "obj_info or end_header");
    }
  }
  if (!has_format) scanner.fail("the header must contain a line 'format ...'");
  const std::size_t end = bytes_.size() - scanner.remaining();
  scanner.next_line();
  at_ = bytes_.size() - scanner.remaining();
  line_ = scanner.line();
  // In files with bare \r line ends, a first data byte \n belongs to the data.
  const bool has_bare_returns = format_ != Format::ascii && ends_lines_with_return(bytes_);
  if (has_bare_returns && bytes_.substr(end, at_ - end).ends_with("\r\n")) --at_;
}

PlyReader::PropertyIndices PlyReader::find_property_indices(
    const PlyElement& element, std::span<const std::string_view> scalars,
    std::span<const std::string_view> lists) const {
  PropertyIndices property_indices{std::vector<int>(element.properties.size(), -1),
                                   element.properties.size(), 0};
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    const PlyProperty& property = element.properties[p];
    property_indices.smallest_row +=
        format_ == Format::ascii ? 2 : compute_size(property.count_type.value_or(property.type));
    const auto names = property.count_type ? lists : scalars;
    const auto name = std::find(names.begin(), names.end(), property.name);
    if (name == names.end()) continue;
    if (!property.count_type) {
      property_indices.column[p] = static_cast<int>(name - names.begin());
    } else if (property_indices.list == element.properties.size()) {
      property_indices.list = p;
    }
  }
  return property_indices;
}

PlyTable PlyReader::read_element(std::span<const std::string_view> scalars) {
  return read_rows(scalars, {}, elements_.at(next_element_).count);
}

PlyTable PlyReader::read_rows(std::span<const std::string_view> scalars,
                              std::span<const std::string_view> lists, std::uint64_t max_rows) {
  const PlyElement& element = elements_.at(next_element_);
  const std::uint64_t left = element.count - next_row_;
  const Rows rows{element, next_row_, next_row_ + std::min(left, max_rows)};
  PlyTable table;
  table.columns.resize(scalars.size());
  if (element.properties.empty() || element.count == 0) {
    table.rows = rows.end - rows.begin;
    pass_rows(table.rows);
    return table;
  }
  const PropertyIndices property_indices = find_property_indices(element, scalars, lists);

  // The last ASCII row needs no line end, hence the 1.
  if (left > (bytes_.size() - at_ + 1) / std::max<std::size_t>(property_indices.smallest_row, 1)) {
    fail("the header declares " + std::to_string(element.count) + " of element '" + element.name +
         "', but the file is too short; it may be truncated");
  }
  for (const int column : property_indices.column) {
    if (column >= 0) table.columns[static_cast<std::size_t>(column)].reserve(rows.end - rows.begin);
  }
  if (property_indices.list < element.properties.size()) {
    table.list_begin.reserve(rows.end - rows.begin + 1);
    table.list_begin.push_back(0);
  }
  format_ == Format::ascii ? read_ascii(rows, property_indices, table)
                           : read_binary(rows, property_indices, table);
  pass_rows(table.rows);
  return table;
}

void PlyReader::pass_rows(std::uint64_t count) {
  next_row_ += count;
  if (next_row_ < elements_[next_element_].count) return;
  next_row_ = 0;
  ++next_element_;
}

void PlyReader::fail_within(const PlyElement& element, std::uint64_t row) const {
  fail("ends within " + element.name + " " + std::to_string(row) + " of " +
       std::to_string(element.count) + "; it may be truncated");
}

void PlyReader::require_short(const Rows& rows, const PlyTable& table, std::uint64_t values) const {
  if (values <= longest_ply_list) return;
  fail(rows.element.name + " " + std::to_string(rows.begin + table.rows) + " has a list of " +
       std::to_string(values) + " values; the maximum is 1 million");
}

std::int64_t PlyReader::parse_index(const Rows& rows, double value) const {
  constexpr double max = 1e15;  // integers are exact up to this value
  if (std::abs(value) <= max && value == std::floor(value)) {
    return static_cast<std::int64_t>(value);
  }
  fail(rows.element.name + " has a list with " + std::to_string(value) +
       "; its values must be integers");
}

void PlyReader::read_scalars(const Rows& rows, const PropertyIndices& property_indices,
                             PlyTable& table) {
  const PlyElement& element = rows.element;
  std::size_t row_size = 0;
  for (const PlyProperty& property : element.properties) row_size += compute_size(property.type);
  const std::size_t whole_rows = (bytes_.size() - at_) / row_size;
  if (whole_rows < element.count - rows.begin) fail_within(element, rows.begin + whole_rows);
  const bool swap = format_ == Format::big_endian;
  const char* first = bytes_.data() + at_;
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    const PlyType type = element.properties[p].type;
    if (property_indices.column[p] >= 0) {
      auto& column = table.columns[static_cast<std::size_t>(property_indices.column[p])];
      with_type(type, [&]<typename Value>(std::type_identity<Value>) {
        for (std::size_t row = 0; row < rows.end - rows.begin; ++row) {
          column.push_back(load<Value>(first + row * row_size, swap));
        }
      });
    }
    first += compute_size(type);
  }
  table.rows = rows.end - rows.begin;
  at_ += table.rows * row_size;
}

void PlyReader::read_binary(const Rows& rows, const PropertyIndices& property_indices,
                            PlyTable& table) {
  const PlyElement& element = rows.element;
  const bool has_lists = std::ranges::any_of(element.properties, [](const PlyProperty& property) {
    return property.count_type.has_value();
  });
  if (!has_lists) return read_scalars(rows, property_indices, table);
  const bool swap = format_ == Format::big_endian;
  for (std::uint64_t row = rows.begin; row < rows.end && !is_full(table); ++row, ++table.rows) {
    const auto take = [&](std::size_t size) {
      if (size > bytes_.size() - at_) {
        fail_within(element, row);
      }
      const char* start = bytes_.data() + at_;
      at_ += size;
      return start;
    };
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const auto& [name, type, count_type] = element.properties[p];
      const std::size_t size = compute_size(type);
      if (!count_type) {
        const char* value = take(size);
        if (property_indices.column[p] < 0) continue;
        table.columns[static_cast<std::size_t>(property_indices.column[p])].push_back(
            load(type, value, swap));
        continue;
      }
      const double count = load(*count_type, take(compute_size(*count_type)), swap);
      if (count < 0.0) {
        fail(element.name + " " + std::to_string(row) + " has a list of negative length");
      }
      const auto values = static_cast<std::size_t>(count);
      const char* start = take(values * size);
      if (p != property_indices.list) continue;
      require_short(rows, table, values);
      for (std::size_t i = 0; i < values; ++i) {
        table.list_values.push_back(parse_index(rows, load(type, start + i * size, swap)));
      }
      table.list_begin.push_back(table.list_values.size());
    }
  }
}

void PlyReader::read_ascii(const Rows& rows, const PropertyIndices& property_indices,
                           PlyTable& table) {
  const PlyElement& element = rows.element;
  TextScanner scanner(name_, bytes_.substr(at_), line_);
  for (std::uint64_t row = rows.begin; row < rows.end && !is_full(table); ++row, ++table.rows) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (!property.count_type) {
        const auto word = scanner.word();
        if (property_indices.column[p] < 0 && word) continue;
        const auto value = scanner.number<double>(word, "a number (" + property.name + ")");
        if (property_indices.column[p] >= 0) {
          table.columns[static_cast<std::size_t>(property_indices.column[p])].push_back(value);
        }
        continue;
      }
      const auto count = scanner.number<std::uint32_t>(scanner.word(), "the length of a list");
      if (p == property_indices.list) require_short(rows, table, count);
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto word = scanner.word();
        if (p != property_indices.list && word) continue;
        // Some programs write indices as real numbers.
        const auto value = is_integer(property.type)
                               ? scanner.number<std::int64_t>(word, "an index")
                               : parse_index(rows, scanner.number<double>(word, "an index"));
        if (p == property_indices.list) table.list_values.push_back(value);
      }
      if (p == property_indices.list) table.list_begin.push_back(table.list_values.size());
    }
  }
  at_ = bytes_.size() - scanner.remaining();
  line_ = scanner.line();
}

}  // namespace skycap::geometry
