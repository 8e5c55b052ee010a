#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>

#include "flight/export/text.h"
#include "flight/flown/imported_route.h"
#include "flight/flown/position_table.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

/// Permitted range of a column, in degrees, metres or seconds.
struct ColumnRange {
  double min, max;
  const char* unit;
};

ColumnRange find_range(Column column) {
  switch (column) {
    case Column::latitude:
      return {-90.0, 90.0, "degrees"};
    case Column::longitude:
      return {-180.0, 180.0, "degrees"};
    case Column::yaw:
    case Column::camera_yaw:
      return {-360.0, 360.0, "degrees"};
    case Column::camera_pitch:
      return {-180.0, 90.0, "degrees"};
    case Column::hold:
      return {0.0, 3600.0, "s"};
    case Column::photo:
      return {0.0, 100.0, "photos"};
    default:
      return {-1000.0, 10'000.0, "m"};
  }
}

/// Reads the rows of a waypoint table.
class WaypointReader {
 public:
  WaypointReader(const PositionTable& table, TrackHeights heights) : table_(table) {
    const bool has_absolute = table[Column::sea_level] || table[Column::ellipsoid];
    const bool has_takeoff = table[Column::above_takeoff].has_value();
    const bool is_above_takeoff =
        heights == TrackHeights::takeoff || (heights == TrackHeights::automatic && has_takeoff);
    if (is_above_takeoff) {
      datum_ = HeightDatum::takeoff;
      height_ = has_takeoff ? Column::above_takeoff : absolute_column();
    } else {
      if (!has_absolute) {
        throw Error(ErrorKind::bad_file, "contains no absolute height; use --heights takeoff");
      }
      height_ = absolute_column();
      const bool is_ellipsoid = height_ == Column::ellipsoid;
      datum_ = is_ellipsoid ? HeightDatum::ellipsoid : HeightDatum::mean_sea_level;
    }
  }

  FilePoint read(const PositionTable::Row& row) const {
    FilePoint point{require(row, Column::latitude), require(row, Column::longitude),
                    require(row, height_)};
    point.datum = datum_;
    if (point.latitude_deg == 0.0 && point.longitude_deg == 0.0) {
      fail(row, "has the position 0, 0, which receivers report without a fix");
    }
    // The camera's heading, where it is known, is that of the vehicle's nose.
    point.yaw_deg =
        find(row, Column::camera_yaw).value_or(find(row, Column::yaw).value_or(unspecified));
    point.pitch_deg = find(row, Column::camera_pitch).value_or(unspecified);
    point.hold = find(row, Column::hold).value_or(0.0);
    const double photos = find(row, Column::photo).value_or(0.0);
    if (photos != std::floor(photos)) fail(row, "must contain an integer number of photos");
    point.captures = static_cast<int>(photos);
    return point;
  }

 private:
  Column absolute_column() const {
    return table_[Column::sea_level] ? Column::sea_level : Column::ellipsoid;
  }

  [[noreturn]] static void fail(const PositionTable::Row& row, const std::string& what) {
    throw Error(ErrorKind::bad_file, "line " + std::to_string(row.line) + " " + what);
  }

  /// Returns the value of a field, or std::nullopt if the column or its value is missing.
  std::optional<double> find(const PositionTable::Row& row, Column column) const {
    const std::optional<TableColumn>& place = table_[column];
    if (!place || place->index >= row.fields.size()) return std::nullopt;
    std::string text = unquoted_field(row.fields[place->index]);
    if (text.empty()) return std::nullopt;
    if (column == Column::photo) {
      std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
      if (text == "true" || text == "yes") return 1.0;
      if (text == "false" || text == "no") return 0.0;
    }
    const ColumnRange range = find_range(column);
    const std::optional<double> number = to_number(text);
    const double value = number ? place->unit * *number : 0.0;
    if (number && value >= range.min && value <= range.max) return value;
    fail(row, "has \"" + text.substr(0, 40) + "\" in the column " + place->name +
                  "; it must be a number from " + fixed(range.min, 0) + " to " +
                  fixed(range.max, 0) + " " + range.unit);
  }

  double require(const PositionTable::Row& row, Column column) const {
    const std::optional<double> value = find(row, column);
    if (!value) fail(row, "has no value in the column " + table_[column]->name);
    return *value;
  }

  const PositionTable& table_;
  Column height_ = Column::above_takeoff;
  HeightDatum datum_ = HeightDatum::takeoff;
};

}  // namespace

GeodeticRoute read_waypoint_table(std::string_view text, TrackHeights heights) {
  PositionTable table(text);
  const WaypointReader reader(table, heights);
  GeodeticRoute route{.kind = "waypoint table"};
  while (const auto row = table.next()) {
    route.points.push_back(reader.read(*row));
    route.items.push_back("line " + std::to_string(row->line));
  }
  return route;
}

}  // namespace skycap::flight
