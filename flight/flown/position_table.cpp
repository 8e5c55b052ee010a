#include "flight/flown/position_table.h"

#include <cctype>
#include <utility>

#include "flight/export/text.h"
#include "geometry/error.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

constexpr double metres_per_foot = 0.3048;

/// Names of columns in lower-case letters without the unit, in descending order of preference.
struct ColumnNames {
  Column column;
  std::vector<std::string_view> names;
};

const std::vector<ColumnNames>& known_columns() {
  static const std::vector<ColumnNames> all = {
      {Column::time, {"time", "flytime", "osdflytime", "timestamp", "elapsedtime", "offsettime"}},
      {Column::latitude, {"latitude", "lat", "osdlatitude", "gpslat", "gpslatitude"}},
      {Column::longitude,
       {"longitude", "lon", "lng", "long", "osdlongitude", "gpslong", "gpslongitude"}},
      {Column::above_takeoff,
       {"heightabovetakeoff", "osdheight", "height", "relativealtitude", "relalt",
        "heightabovehome"}},
      {Column::sea_level,
       {"altitudeabovesealevel", "amsl", "altitude", "alt", "osdaltitude", "absalt",
        "absolutealtitude"}},
      {Column::ellipsoid, {"ellipsoidheight", "ellh", "heightaboveellipsoid"}},
      {Column::yaw, {"compassheading", "heading", "yaw", "osdyaw", "aircraftyaw"}},
      {Column::camera_yaw, {"gimbalheading", "gimbalyaw", "cameraheading", "camerayaw"}},
      {Column::camera_pitch,
       {"gimbalpitch", "camerapitch", "gimbalpitchangle", "gimbalpitchrotateangle"}},
      {Column::photo,
       {"isphoto", "camerainfoisphoto", "cameraisphoto", "photo", "capture", "takephoto"}},
      {Column::hold, {"hold", "holdtime", "hover", "hovertime", "stay"}}};
  return all;
}

/// Splits a name such as "height_above_takeoff(feet)" into letters and unit.
std::pair<std::string, std::string> name_and_unit(const std::string& field) {
  std::string letters, unit, *part = &letters;
  for (const unsigned char c : field) {
    if (c == '(' || c == '[') part = &unit;
    if (std::isalpha(c) != 0) part->push_back(static_cast<char>(std::tolower(c)));
  }
  const auto cut = [&](std::string_view ending, std::string_view meaning) {
    if (!unit.empty() || !field.ends_with(ending)) return;
    letters.resize(letters.size() - (ending.size() - 1));
    unit = meaning;
  };
  cut("_deg", "degrees");
  cut("_m", "m");
  cut("_ft", "ft");
  cut("_s", "s");
  cut("_ms", "millisecond");
  return {letters, unit};
}

double compute_unit(const std::string& unit) {
  if (unit.starts_with("feet") || unit == "ft") return metres_per_foot;
  if (unit.starts_with("millisecond") || unit == "ms") return 1e-3;
  return 1.0;
}

}  // namespace

std::string unquoted_field(std::string_view field) {
  std::string text(geometry::trimmed(field));
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
  }
  return text;
}

PositionTable::PositionTable(std::string_view text) : rest_(text) {
  const std::string_view line = next_content();
  if (line.empty()) throw Error(ErrorKind::bad_file, "contains no header line");
  if (line.find(',') == std::string_view::npos) {
    separator_ = line.find(';') != std::string_view::npos ? ';' : '\t';
  }
  std::vector<std::string> header = split(line, separator_);
  for (std::string& field : header) field = unquoted_field(field);
  find_columns(header);
}

void PositionTable::find_columns(const std::vector<std::string>& header) {
  for (const ColumnNames& wanted : known_columns()) {
    std::optional<TableColumn>& found = columns_[static_cast<std::size_t>(wanted.column)];
    for (const std::string_view name : wanted.names) {
      for (std::size_t i = 0; i < header.size() && !found; ++i) {
        const auto [letters, unit] = name_and_unit(header[i]);
        if (letters == name) found = TableColumn{i, compute_unit(unit), header[i]};
      }
    }
  }
  const PositionTable& table = *this;
  const bool has_height =
      table[Column::above_takeoff] || table[Column::sea_level] || table[Column::ellipsoid];
  if (!table[Column::latitude] || !table[Column::longitude] || !has_height) {
    throw Error(ErrorKind::bad_file,
                "the first line must name the columns latitude, longitude and a height "
                "(height_above_takeoff, altitude or ellipsoid_height)");
  }
}

std::string_view PositionTable::next_content() {
  while (!rest_.empty()) {
    const std::string_view line = next_line(rest_);
    ++line_;
    const bool is_content =
        !geometry::trimmed(line).empty() && !line.starts_with("sep=") && !line.starts_with('#');
    if (is_content) return line;
  }
  return {};
}

std::optional<PositionTable::Row> PositionTable::next() {
  const std::string_view line = next_content();
  if (line.empty()) return std::nullopt;
  return Row{line_, split(line, separator_)};
}

}  // namespace skycap::flight
