/// Tables with a position in each row, such as exported flight records and lists of waypoints.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::flight {

/// Meaning of a column.
enum class Column {
  time,
  latitude,
  longitude,
  above_takeoff,
  sea_level,
  ellipsoid,
  yaw,
  camera_yaw,
  camera_pitch,
  photo,
  hold
};

/// Column of a table, and the factor to metres, seconds or degrees.
struct TableColumn {
  std::size_t index = 0;
  double unit = 1.0;
  std::string name;  ///< As in the header line.
};

/// CSV table whose first line names the columns, read row by row. The separator is a comma, a
/// semicolon or a tab. Empty lines, comments (#) and the line "sep=" are skipped.
class PositionTable {
 public:
  struct Row {
    std::size_t line = 0;  ///< Number of the line, from 1.
    std::vector<std::string> fields;
  };

  /// Reads the header of `text`, which must outlive the table. Column names are recognised in the
  /// spelling of common programs, with the units m, ft, s and ms. Throws Error{bad_file} unless it
  /// names the columns latitude, longitude and a height.
  explicit PositionTable(std::string_view text);

  const std::optional<TableColumn>& operator[](Column which) const {
    return columns_[static_cast<std::size_t>(which)];
  }

  /// Returns the next row, or std::nullopt at the end.
  std::optional<Row> next();

 private:
  static constexpr std::size_t num_columns = 11;

  /// Returns the next line with content. Empty at the end.
  std::string_view next_content();
  void find_columns(const std::vector<std::string>& header);

  std::array<std::optional<TableColumn>, num_columns> columns_;
  std::string_view rest_;
  std::size_t line_ = 0;
  char separator_ = ',';
};

/// Returns a field without surrounding spaces and quotes.
std::string unquoted_field(std::string_view field);

}  // namespace skycap::flight
