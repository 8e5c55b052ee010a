#include "flight/flown/imported_route.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "flight/export/export.h"
#include "flight/flown/position_table.h"
#include "flight/interpreter/interpret.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/pose/world.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

std::string name_of(HeightDatum datum) {
  if (datum == HeightDatum::takeoff) return "above take-off";
  return datum == HeightDatum::ellipsoid ? "above the ellipsoid" : "above mean sea level";
}

void require_georeference(bool is_georeferenced) {
  if (is_georeferenced) return;
  throw Error(ErrorKind::bad_config,
              "the route has geodetic coordinates, but the mission has no georeference; set "
              "site.latitude_deg and site.longitude_deg");
}

ImportedRoute place(const GeodeticRoute& content, const FlightFacts& facts) {
  ImportedRoute route{.kind = content.kind, .is_track = content.is_track};
  if (content.points.empty()) throw Error(ErrorKind::bad_file, "contains no waypoint");
  const HeightDatum datum = content.points.front().datum;
  route.heights = name_of(datum);
  route.is_above_takeoff = datum == HeightDatum::takeoff;
  RouteFile file;
  file.points = content.points;
  const std::vector<Vector3d> positions = local_points(file, facts.site, facts.pad);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const FilePoint& point = content.points[i];
    geometry::require_valid_position(positions[i], content.items[i]);
    route.points.push_back({positions[i], static_cast<double>(i), point.yaw_deg, point.pitch_deg,
                            point.hold, point.captures, content.items[i]});
  }
  return route;
}

/// Returns the positions of a mission file as its autopilot would fly it, without climb and landing
/// at the pad.
ImportedRoute read_route_file(const std::filesystem::path& file, const FlightFacts& facts) {
  const InterpretedRoute flown = interpret_file(file, facts);
  ImportedRoute route{.kind = "route file", .heights = "of the file", .is_above_takeoff = true};
  const auto add = [&](const Vector3d& position, const std::string& item) {
    const double time = static_cast<double>(route.points.size());
    route.points.push_back({position, time, unspecified, unspecified, 0.0, 0, item});
    return std::prev(route.points.end());
  };
  std::vector<bool> is_used(flown.stops.size());
  for (const InterpretedSegment& segment : flown.segments) {
    if (segment.is_over_pad) continue;
    if (route.points.empty()) add(segment.start.to, segment.from_item);
    for (const FlownPass& pass : flown.is_fly_through) {
      if (pass.item != segment.to_item) continue;
      const auto point = add(pass.position, "photo before " + pass.item);
      point->yaw_deg = pass.yaw_deg, point->pitch_deg = pass.pitch_deg, point->captures = 1;
    }
    const auto point = add(segment.to, segment.to_item);
    point->hold = segment.hold;
    for (std::size_t i = 0; i < flown.stops.size(); ++i) {
      const InterpretedStop& stop = flown.stops[i];
      if (is_used[i] || (stop.position - segment.to).norm() > rounding_bound) continue;
      is_used[i] = true;
      point->yaw_deg = stop.yaw_deg, point->pitch_deg = stop.pitch_deg;
      point->captures += stop.captures;
      point->hold = std::max(point->hold, stop.hold + stop.hold_after);
      break;
    }
  }
  for (const std::string& problem : flown.problems) route.warnings.push_back(problem);
  return route;
}

ImportedRoute read_track_file(const std::filesystem::path& file, const FlightFacts& facts,
                              bool is_georeferenced, TrackHeights heights) {
  const FlownLog log = read_flown_log(file);
  FlownTrack track = place_track(log, facts.site, is_georeferenced, facts.pad, heights);
  ImportedRoute route{.kind = track.kind,
                      .heights = track.heights,
                      .is_track = true,
                      .is_above_takeoff = track.heights.find("above take-off") == 0 ||
                                          track.heights.find("above the first") == 0,
                      .warnings = std::move(track.warnings)};
  const double begin = track.states.front().time;
  const auto add = [&](const TrackState& state, int captures) {
    const double yaw = std::isfinite(state.camera_yaw_deg) ? state.camera_yaw_deg : state.yaw_deg;
    route.points.push_back(
        {state.position, state.time, yaw, state.camera_pitch_deg, 0.0, captures,
         (captures > 0 ? "capture at " : "position at ") + fixed(state.time - begin, 1) + " s"});
  };
  auto capture = track.captures.begin();
  for (const TrackState& state : track.states) {
    for (; capture != track.captures.end() && capture->time <= state.time; ++capture) {
      add(*capture, 1);
    }
    add(state, 0);
  }
  for (; capture != track.captures.end(); ++capture) add(*capture, 1);
  return route;
}

constexpr std::string_view local_header = "x,y,z,heading_deg,gimbal_pitch_deg,photos";
constexpr std::string_view fleet_header = "x,y,z,heading_deg,gimbal_pitch_deg,photos,vehicle";

/// Returns true for integers from `min` to 100.
bool is_small_count(double value, double min) {
  return value >= min && value <= 100.0 && value == std::floor(value);
}

/// Reads a waypoint table whose positions are in the mission's frame.
ImportedRoute read_local_table(std::string_view text) {
  ImportedRoute route{.kind = "waypoint table", .heights = "mission frame"};
  const std::string_view header = geometry::trimmed(next_line(text));
  const bool is_fleet = header == fleet_header;
  for (std::size_t line = 2; !text.empty(); ++line) {
    const std::string_view row = geometry::trimmed(next_line(text));
    if (row.empty()) continue;
    const std::string item = "line " + std::to_string(line);
    std::vector<double> values;
    for (const std::string& field : split(row, ',')) {
      values.push_back(to_number(geometry::trimmed(field)).value_or(unspecified));
    }
    const bool has_numbers = values.size() == (is_fleet ? 7U : 6U) &&
                             std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
    if (!has_numbers || std::abs(values[3]) > 360.0 || std::abs(values[4]) > 180.0 ||
        !is_small_count(values[5], 0.0) || (is_fleet && !is_small_count(values[6], 1.0))) {
      throw Error(ErrorKind::bad_file, item + " must contain the numbers " + std::string(header) +
                                           " with angles up to 360 and up to 100 photos" +
                                           (is_fleet ? " and vehicles from 1 to 100" : ""));
    }
    const Vector3d position(values[0], values[1], values[2]);
    geometry::require_valid_position(position, item);
    route.points.push_back({position, static_cast<double>(route.points.size()), values[3],
                            values[4], 0.0, static_cast<int>(values[5]), item,
                            is_fleet ? static_cast<std::size_t>(values[6]) : 0});
  }
  return route;
}

ImportedRoute read(const std::filesystem::path& file, const FlightFacts& facts,
                   bool is_georeferenced, TrackHeights heights) {
  const std::string extension = geometry::lower_extension(file);
  if (extension == ".csv") {
    const std::string content = geometry::read_file(file, largest_route_file);
    const std::string_view text = geometry::without_mark(content);
    const std::string_view first = text.substr(0, text.find('\n'));
    if (first.find("curvesize(") != std::string_view::npos) {
      require_georeference(is_georeferenced);
      return read_route_file(file, facts);
    }
    const std::string_view header = geometry::trimmed(first);
    if (header == local_header || header == fleet_header) return read_local_table(text);
    const bool is_trajectory = text.starts_with("# frame");
    if (!is_trajectory && !PositionTable(text)[Column::time]) {
      require_georeference(is_georeferenced);
      return place(read_waypoint_table(text, heights), facts);
    }
  } else if (extension == ".kml") {
    require_georeference(is_georeferenced);
    return place(read_kml_route(geometry::read_file(file, largest_route_file), heights), facts);
  } else if (extension == ".plan" || extension == ".waypoints" || extension == ".kmz" ||
             extension == ".geojson") {
    require_georeference(is_georeferenced);
    return read_route_file(file, facts);
  }
  return read_track_file(file, facts, is_georeferenced, heights);
}

}  // namespace

ImportedRoute read_imported_route(const std::filesystem::path& file, const FlightFacts& facts,
                                  bool is_georeferenced, TrackHeights heights) {
  try {
    ImportedRoute route = read(file, facts, is_georeferenced, heights);
    if (route.points.empty()) throw Error(ErrorKind::bad_file, "contains no waypoint");
    return route;
  } catch (const Error& error) {
    const std::string what = error.what();
    if (what.starts_with(file.string())) throw;
    throw Error(error.kind(), file.string() + ": " + what);
  }
}

std::size_t remove_pad_column(ImportedRoute& route, const Vector3d& pad, double radius,
                              double height) {
  const auto is_outside = [&](const ImportedPoint& point) {
    const Vector3d from_pad = point.position - pad;
    return from_pad.head<2>().norm() > radius || from_pad.z() > height || point.captures > 0;
  };
  std::vector<ImportedPoint>& points = route.points;
  const std::size_t before = points.size();
  points.erase(std::find_if(points.rbegin(), points.rend(), is_outside).base(), points.end());
  points.erase(points.begin(), std::ranges::find_if(points, is_outside));
  return before - points.size();
}

}  // namespace skycap::flight
