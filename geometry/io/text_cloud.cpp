// Clouds as text, as written by CloudCompare, laser scanners and spreadsheets.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/io/cloud_parsers.h"
#include "geometry/io/text/text_scanner.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;
using std::string_view;

/// A line with more numbers than any point has lost its line ends.
constexpr std::size_t max_columns = 200;
constexpr std::size_t max_line = 1 << 16;  // bytes

/// Line format of a file.
struct Layout {
  char separator = ' ';  ///< ' ', ',' or ';', optionally surrounded by blanks
  bool has_decimal_commas = false;
  std::array<std::size_t, 3> columns{0, 1, 2};  ///< indices of x, y and z

  bool is_plain() const {
    return separator == ' ' && !has_decimal_commas &&
           columns == std::array<std::size_t, 3>{0, 1, 2};
  }
};

string_view without_quotes(string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 && (text.front() == '"' || text.front() == '\'') &&
      text.front() == text.back()) {
    text = trimmed(text.substr(1, text.size() - 2));
  }
  return text;
}

std::vector<string_view> split_fields(string_view line, char separator) {
  std::vector<string_view> fields;
  if (separator == ' ') {
    constexpr string_view blanks = " \t\f\v";
    for (std::size_t begin = line.find_first_not_of(blanks); begin != string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
      fields.push_back(without_quotes(line.substr(begin, end - begin)));
      begin = line.find_first_not_of(blanks, end);
    }
    return fields;
  }
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    fields.push_back(without_quotes(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return fields;
}

/// Detects the layout from a line with a point or a header.
Layout detect_layout(string_view line) {
  Layout layout;
  if (line.find(';') != string_view::npos) {
    layout.separator = ';';
    layout.has_decimal_commas = true;
    return layout;
  }
  if (line.find(',') == string_view::npos) return layout;
  const std::vector<string_view> words = split_fields(line, ' ');
  const auto is_number = [](string_view word) {
    return !word.starts_with(',') && !word.ends_with(',') && number_with_comma(word).has_value();
  };
  const bool has_blanks =
      words.size() >= 3 && std::all_of(words.begin(), words.begin() + 3, is_number);
  if (!has_blanks) layout.separator = ',';
  layout.has_decimal_commas =
      has_blanks && std::any_of(words.begin(), words.begin() + 3, has_decimal_comma);
  return layout;
}

/// Returns the name of a column without its unit, such as "x" for "//X[m]".
std::string column_name(string_view field) {
  const std::size_t begin = field.find_first_not_of("/#");
  field = without_quotes(field.substr(std::min(begin, field.size())));
  return lower_case(trimmed(field.substr(0, field.find_first_of("[("))));
}

std::optional<std::array<std::size_t, 3>> columns_named(const std::vector<string_view>& fields) {
  constexpr std::array<std::array<string_view, 3>, 3> names{
      {{"x", "east", "easting"}, {"y", "north", "northing"}, {"z", "height", "elevation"}}};
  std::array<std::size_t, 3> columns{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bool is_there = false;
    for (const string_view name : names[axis]) {
      for (std::size_t i = 0; i < fields.size() && !is_there; ++i) {
        if (column_name(fields[i]) != name) continue;
        columns[axis] = i;
        is_there = true;
      }
    }
    if (!is_there) return std::nullopt;
  }
  return columns;
}

bool is_count(string_view line) {
  return !line.empty() && line.size() < 19 &&
         line.find_first_not_of("0123456789") == string_view::npos;
}

/// Callbacks for all columns of a file.
struct FieldCallbacks {
  const SelectFields& select;
  const FieldValues& point;
};

class TextCloud {
 public:
  /// With `fields`, points are passed to them instead of `callback`.
  TextCloud(const fs::path& path, string_view text, const TextChunkCallback& callback,
            const FieldCallbacks* fields = nullptr)
      : fields_(fields),
        path_(path),
        name_(path.string()),
        text_(text),
        scanner_(name_, text),
        callback_(callback) {}

  std::size_t unnamed() const { return unnamed_; }

  std::size_t read() {
    do {
      const auto first = scanner_.word_in_line();
      if (!first) continue;
      if (first->starts_with('#') || first->starts_with("//")) {
        read_comment(*first);
      } else if (layout_ && layout_->is_plain() && fields_ == nullptr) {
        read_plain_point(*first);
      } else {
        read_line(*first);
      }
    } while (scanner_.next_line());
    hand_on();
    require_all();
    return skipped_;
  }

 private:
  /// Reads a comment before the first point, which may name the columns.
  void read_comment(string_view first) {
    if (layout_) return;
    const string_view line = whole_line(first);
    const string_view names = line.substr(std::min(line.find_first_not_of("/# \t"), line.size()));
    const std::vector<string_view> fields = split_fields(names, detect_layout(names).separator);
    if (const auto columns = columns_named(fields)) {
      named_columns_ = columns;
      set_names(fields);
    }
  }

  string_view whole_line(string_view first) {
    const string_view rest = scanner_.remaining_line();
    const char* const end = rest.empty() ? first.data() + first.size() : rest.data() + rest.size();
    const auto size = static_cast<std::size_t>(end - first.data());
    if (size > max_line) {
      scanner_.fail(
          "is longer than 64 KiB; a point cloud in text format must have one point per line");
    }
    return {first.data(), size};
  }

  void read_plain_point(string_view first) {
    std::array<double, 3> point{};
    point[0] = scanner_.number<double>(first, "a coordinate");
    const auto second = scanner_.word_in_line();
    if (!second && has_count_ && is_count(first)) return add_count(first);
    point[1] = scanner_.number<double>(second, "a coordinate");
    point[2] = scanner_.number<double>(scanner_.word_in_line(), "a coordinate");
    add(point);
  }

  void read_line(string_view first) {
    const string_view line = whole_line(first);
    if (is_count(line)) return add_count(line);
    if (!layout_) {
      if (read_header(line)) return;
      layout_ = detect_layout(line);
      // A comment that names x, y and z is a header only if it names every column.
      const std::size_t count = split_fields(line, layout_->separator).size();
      const bool is_named = named_columns_ && (has_header_ || named_fields_ == count);
      if (is_named) layout_->columns = *named_columns_;
      select_fields(is_named, count);
    }
    const std::vector<string_view> fields = split_fields(line, layout_->separator);
    if (fields.size() > max_columns) {
      scanner_.fail("has " + std::to_string(fields.size()) +
                    " numbers; a point cloud in text format must have one point per line");
    }
    const auto number = [&](std::size_t column, const std::string& what) {
      if (column >= fields.size() || fields[column].empty()) {
        scanner_.fail("ends where " + what + " is expected");
      }
      const auto value = layout_->has_decimal_commas ? number_with_comma(fields[column])
                                                     : number_in(fields[column]);
      if (!value) scanner_.fail_on_word(fields[column], what);
      return *value;
    };
    std::array<double, 3> point{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      point[axis] = number(layout_->columns[axis], "a coordinate");
    }
    columns_of_last_ = fields.size();
    if (fields_ == nullptr) return add(point);
    values_.assign(point.begin(), point.end());
    for (const std::size_t column : selected_) values_.push_back(number(column, "a number"));
    ++points_;
    fields_->point(values_);
  }

  void set_names(const std::vector<string_view>& fields) {
    named_fields_ = fields.size();
    names_.clear();
    for (const string_view field : fields) names_.push_back(column_name(field));
  }

  void select_fields(bool is_named, std::size_t columns) {
    if (fields_ == nullptr) return;
    const std::vector<std::string> names = is_named ? names_ : std::vector<std::string>();
    selected_ = fields_->select(names);
    unnamed_ = is_named ? 0 : columns - std::min<std::size_t>(columns, 3);
  }

  /// Returns whether the first line with content names the columns.
  bool read_header(string_view line) {
    if (has_header_) return false;
    const std::vector<string_view> fields = split_fields(line, detect_layout(line).separator);
    const auto is_number = [](string_view field) { return number_with_comma(field).has_value(); };
    if (fields.size() < 3 || std::ranges::any_of(fields, is_number)) return false;
    has_header_ = true;
    const auto columns = columns_named(fields);
    if (!columns) scanner_.fail("is a header that does not name the columns x, y and z");
    named_columns_ = columns;
    set_names(fields);
    return true;
  }

  void add_count(string_view line) {
    const bool is_second = has_count_ && points_ + skipped_ == 0;
    if (is_second) {
      scanner_.fail(
          "contains a second point count, as in PTX files, which are not supported; save the cloud "
          "as E57 or PTS");
    }
    has_count_ = true;
    declared_ += std::stoull(std::string(line));
  }

  void add(const std::array<double, 3>& point) {
    if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2])) {
      ++skipped_;
      return;
    }
    chunk_.push_back(cloud_position(path_, points_ + skipped_, point[0], point[1], point[2]));
    ++points_;
    if (chunk_.size() == points_per_chunk) hand_on();
  }

  void hand_on() {
    if (!chunk_.empty()) callback_(chunk_, text_.size() - scanner_.remaining());
    chunk_.clear();
  }

  void require_all() const {
    if (points_ + skipped_ < declared_) {
      fail_cloud(path_, "ends after " + std::to_string(points_ + skipped_) + " of its " +
                            std::to_string(declared_) + " points");
    }
    // The whole cloud is on one line.
    constexpr std::size_t three_points = 9;
    if (points_ == 1 && columns_of_last_ > three_points && columns_of_last_ % 3 == 0) {
      fail_cloud(path_, "has " + std::to_string(columns_of_last_) +
                            " numbers on a single line; write one point per line");
    }
  }

  const FieldCallbacks* fields_;
  std::vector<std::string> names_;     ///< of all columns
  std::vector<std::size_t> selected_;  ///< columns after the coordinates
  std::vector<double> values_;
  std::size_t unnamed_ = 0;
  const fs::path& path_;
  const std::string name_;
  string_view text_;
  TextScanner scanner_;
  const TextChunkCallback& callback_;
  std::optional<Layout> layout_;  ///< set after the first point
  std::optional<std::array<std::size_t, 3>> named_columns_;
  std::size_t named_fields_ = 0;  ///< number of columns named by the comment
  bool has_header_ = false, has_count_ = false;
  std::size_t declared_ = 0, points_ = 0, skipped_ = 0, columns_of_last_ = 0;
  std::vector<Eigen::Vector3f> chunk_;
};

}  // namespace

std::size_t read_text_cloud(const fs::path& path, string_view text,
                            const TextChunkCallback& callback) {
  return TextCloud(path, text, callback).read();
}

TextColumns read_text_fields(const fs::path& path, string_view text, const SelectFields& select,
                             const FieldValues& callback) {
  const FieldCallbacks fields{select, callback};
  const TextChunkCallback unused = [](std::span<const Eigen::Vector3f>, std::size_t) {};
  TextCloud cloud(path, text, unused, &fields);
  cloud.read();
  return {cloud.unnamed()};
}

}  // namespace skycap::geometry
