#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pugixml.hpp>

#include "flight/export/text.h"
#include "flight/export/trajectory_file.h"
#include "flight/flown/flown_readers.h"
#include "flight/flown/position_table.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

[[noreturn]] void fail_line(std::size_t line, const std::string& what) {
  throw Error(ErrorKind::bad_file, "line " + std::to_string(line) + " " + what);
}

// ---- CSV tables -------------------------------------------------------------------------------

/// Adds the rows of a table.
class TableRows {
 public:
  explicit TableRows(const PositionTable& table) : table_(table) {
    const bool is_ellipsoid = !table_[Column::sea_level] && table_[Column::ellipsoid];
    builder_.log().datum = is_ellipsoid ? HeightDatum::ellipsoid : HeightDatum::mean_sea_level;
    builder_.log().has_captures = table_[Column::photo].has_value();
  }

  void add(const std::vector<std::string>& fields, std::size_t line) {
    const double latitude = read(fields, Column::latitude, line);
    const double longitude = read(fields, Column::longitude, line);
    const double above_takeoff = read(fields, Column::above_takeoff, line);
    double height = read(fields, Column::sea_level, line);
    if (std::isnan(height)) height = read(fields, Column::ellipsoid, line);
    // Without an absolute height, only the one above take-off is used.
    if (std::isnan(height)) height = above_takeoff;
    double time = read(fields, Column::time, line);
    if (std::isnan(time)) time = static_cast<double>(line);
    builder_.set_yaw(time, read(fields, Column::yaw, line));
    builder_.set_camera(time, read(fields, Column::camera_yaw, line),
                        read(fields, Column::camera_pitch, line));
    const Vector3d location(latitude, longitude, height);
    builder_.add_position(time, location, above_takeoff);
    // The mark stays on while a photo is stored.
    const double photo = read(fields, Column::photo, line);
    const bool is_photo = photo != 0.0 && !std::isnan(photo);
    if (is_photo && !was_photo_) builder_.add_capture(time, location, above_takeoff);
    was_photo_ = is_photo;
  }

  FlownLog finish() { return builder_.finish("contains no row with a position"); }

 private:
  double read(const std::vector<std::string>& fields, Column which, std::size_t line) const {
    const std::optional<TableColumn>& place = table_[which];
    if (!place || place->index >= fields.size()) return unspecified;
    const std::string text = unquoted_field(fields[place->index]);
    if (text.empty()) return unspecified;
    if (which == Column::photo && (text == "True" || text == "true")) return 1.0;
    if (which == Column::photo && (text == "False" || text == "false")) return 0.0;
    const auto value = to_number(text);
    if (value) return place->unit * *value;
    if (which == Column::latitude || which == Column::longitude) {
      fail_line(line, "has \"" + text + "\" as a coordinate; it must be a number in degrees");
    }
    return unspecified;
  }

  const PositionTable& table_;
  FlownLogBuilder builder_{"CSV table"};
  bool was_photo_ = false;
};

// ---- Tables of photos and subtitles -----------------------------------------------------------

/// Returns the number that ends before `label`, such as in "43.48129633,Lat".
std::optional<double> number_before(std::string_view line, std::string_view label) {
  const std::size_t end = line.find(label);
  if (end == std::string_view::npos) return std::nullopt;
  const std::size_t begin = line.find_last_of("\t ", end);
  return to_number(
      geometry::trimmed(line.substr(begin == std::string_view::npos ? 0 : begin + 1,
                                    end - (begin == std::string_view::npos ? 0 : begin + 1))));
}

/// Returns the number after a label such as "latitude:" or "rel_alt:".
std::optional<double> number_after(std::string_view line, std::string_view label) {
  const std::size_t found = line.find(label);
  if (found == std::string_view::npos) return std::nullopt;
  std::string_view rest = line.substr(found + label.size());
  rest.remove_prefix(std::min(rest.find_first_not_of(" :"), rest.size()));
  return to_number(rest.substr(0, std::min(rest.find_first_of(" ]\t,"), rest.size())));
}

/// Position in a subtitle: latitude, longitude and height, and the height above take-off.
struct SubtitlePosition {
  Vector3d location;
  double above_takeoff = unspecified;
};

/// Reads "[latitude: 48.1] [longitude: 11.5] [rel_alt: 5.0 abs_alt: 500.0]".
std::optional<SubtitlePosition> labelled_position(std::string_view line) {
  const auto latitude = number_after(line, "latitude"), longitude = number_after(line, "longitude");
  if (!latitude || !longitude) return std::nullopt;
  const double above = number_after(line, "rel_alt").value_or(unspecified);
  return SubtitlePosition{{*latitude, *longitude, number_after(line, "abs_alt").value_or(above)},
                          above};
}

/// Reads "GPS(11.5,48.1,16) BAROMETER:5.0" of older drones. The third number is a height or the
/// number of satellites, and is ignored. Most drones write the longitude first.
std::optional<SubtitlePosition> unlabelled_position(std::string_view line) {
  constexpr std::string_view label = "GPS(";
  const std::size_t found = line.find(label);
  if (found == std::string_view::npos) return std::nullopt;
  const std::string_view rest = line.substr(found + label.size());
  const std::vector<std::string> fields = split(rest.substr(0, rest.find(')')), ',');
  if (fields.size() < 2) return std::nullopt;
  const auto first = to_number(geometry::trimmed(fields[0])),
             second = to_number(geometry::trimmed(fields[1]));
  std::string_view barometer = line.substr(std::min(line.find("BAROMETER"), line.size()));
  barometer.remove_prefix(std::min(barometer.find_first_of("-0123456789"), barometer.size()));
  const auto above = to_number(barometer.substr(0, barometer.find_first_not_of("-.0123456789")));
  if (!first || !second || !above) return std::nullopt;
  const bool is_latitude_first = std::abs(*second) > 90.0;
  return SubtitlePosition{
      {is_latitude_first ? *first : *second, is_latitude_first ? *second : *first, *above}, *above};
}

/// Returns the time of "00:01:02,345 --> ..." [s].
std::optional<double> subtitle_time(std::string_view line) {
  const std::size_t arrow = line.find(" --> ");
  if (arrow == std::string_view::npos) return std::nullopt;
  std::string text(line.substr(0, arrow));
  std::ranges::replace(text, ',', '.');
  double seconds = 0.0;
  for (const std::string& part : split(text, ':')) {
    const auto value = to_number(part);
    if (!value) return std::nullopt;
    seconds = 60.0 * seconds + *value;
  }
  return seconds;
}

/// Returns the seconds since an arbitrary day of "2026-05-01T10:11:12.5Z".
std::optional<double> iso_time(std::string_view text) {
  const std::size_t t = text.find('T');
  if (t == std::string_view::npos) return std::nullopt;
  const std::vector<std::string> date = split(text.substr(0, t), '-');
  std::string_view clock = text.substr(t + 1);
  clock = clock.substr(0, clock.find_first_of("Z+-"));
  if (date.size() != 3) return std::nullopt;
  double seconds = 0.0;
  for (const std::string& part : split(clock, ':')) {
    const auto value = to_number(part);
    if (!value) return std::nullopt;
    seconds = 60.0 * seconds + *value;
  }
  const auto year = to_number(date[0]), month = to_number(date[1]), day = to_number(date[2]);
  if (!year || !month || !day) return std::nullopt;
  // Days from civil (Hinnant), valid for all dates of the Gregorian calendar.
  const double y = *month <= 2.0 ? *year - 1.0 : *year;
  const double era = std::floor(y / 400.0), of_era = y - 400.0 * era;
  const double m = *month + (*month > 2.0 ? -3.0 : 9.0);
  const double of_year = std::floor((153.0 * m + 2.0) / 5.0) + *day - 1.0;
  const double days = 146097.0 * era + 365.0 * of_era + std::floor(of_era / 4.0) -
                      std::floor(of_era / 100.0) + of_year;
  return 86400.0 * days + seconds;
}

}  // namespace

FlownLog read_csv_track(std::string_view text) {
  PositionTable table(text);
  TableRows rows(table);
  while (const auto row = table.next()) rows.add(row->fields, row->line);
  return rows.finish();
}

FlownLog read_mrk_track(std::string_view text) {
  FlownLogBuilder builder("table of DJI photos (.MRK)");
  builder.log().datum = HeightDatum::ellipsoid;
  builder.log().has_captures = true;
  std::size_t number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = next_line(rest);
    ++number;
    const std::vector<std::string> words = geometry::split_words(line);
    if (words.empty()) continue;
    // Photo number, time of the week [s], week, and the position of the camera.
    std::optional<double> time, latitude, longitude, height;
    if (words.size() > 1) time = to_number(words[1]);
    latitude = number_before(line, ",Lat");
    longitude = number_before(line, ",Lon");
    height = number_before(line, ",Ellh");
    if (!time || !latitude || !longitude || !height) {
      if (rest.empty()) {
        builder.warn("the last line is incomplete");
        break;
      }
      fail_line(number, "must contain a time and a position (Lat, Lon, Ellh)");
    }
    const Vector3d location(*latitude, *longitude, *height);
    builder.add_position(*time, location, unspecified);
    builder.add_capture(*time, location, unspecified);
  }
  FlownLog log = builder.finish("contains no photo");
  // Photos are not a track, so the time between them does not count as a gap.
  std::erase_if(log.warnings, [](const std::string& warning) {
    return warning.find("without positions") != std::string::npos;
  });
  return log;
}

FlownLog read_srt_track(std::string_view text) {
  FlownLogBuilder builder("subtitles of a DJI video");
  double time = unspecified;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = next_line(rest);
    time = subtitle_time(line).value_or(time);
    std::optional<SubtitlePosition> position = labelled_position(line);
    if (!position) position = unlabelled_position(line);
    if (!position || std::isnan(time)) continue;
    builder.add_position(time, position->location, position->above_takeoff);
  }
  return builder.finish("contains no position; enable video subtitles in the DJI app");
}

FlownLog read_gpx_track(const std::string& text) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  FlownLogBuilder builder("GPX track");
  if (!parsed)
    builder.warn("the file is incomplete or damaged: " + std::string(parsed.description()));
  std::size_t count = 0;
  for (const pugi::xml_node& track : document.child("gpx").children("trk")) {
    for (const pugi::xml_node& segment : track.children("trkseg")) {
      for (const pugi::xml_node& point : segment.children("trkpt")) {
        const double number = static_cast<double>(count++);
        const pugi::xml_node height = point.child("ele");
        if (!height) continue;
        const std::optional<double> stated = iso_time(point.child("time").text().as_string());
        const double time = stated ? *stated : number;
        builder.add_position(
            time,
            {point.attribute("lat").as_double(unspecified),
             point.attribute("lon").as_double(unspecified), height.text().as_double(unspecified)},
            unspecified);
      }
    }
  }
  return builder.finish("contains no track point with a height (trk, trkseg, trkpt, ele)");
}

FlownLog read_tum_track(const std::string& text) {
  FlownLogBuilder builder("TUM trajectory");
  builder.log().is_local = true;
  for (const TimedPose& pose : read_tum(text)) {
    const Vector3d axis = pose.world_from_camera.linear().col(2);
    const double yaw = std::atan2(axis.x(), axis.y()) / geometry::radians_per_degree;
    const double pitch = std::asin(std::clamp(axis.z(), -1.0, 1.0)) / geometry::radians_per_degree;
    builder.set_yaw(pose.time, yaw);
    builder.set_camera(pose.time, yaw, pitch);
    builder.add_position(pose.time, pose.world_from_camera.translation(), unspecified);
  }
  return builder.finish("contains no pose");
}

FlownLog read_trajectory_track(const std::string& text) {
  FlownLogBuilder builder("Skycap trajectory");
  builder.log().is_local = true;
  builder.log().has_captures = true;
  for (const TimedState& state : read_trajectory_csv(text)) {
    const double yaw = state.yaw / geometry::radians_per_degree;
    builder.set_yaw(state.time, yaw);
    builder.set_camera(state.time, yaw, state.pitch / geometry::radians_per_degree);
    builder.add_position(state.time, state.position, unspecified);
    if (state.is_capture) builder.add_capture(state.time, state.position, unspecified);
  }
  return builder.finish("contains no state");
}

}  // namespace skycap::flight
