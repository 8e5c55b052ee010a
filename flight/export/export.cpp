#include "flight/export/export.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "flight/export/map_files.h"
#include "flight/export/mavlink_files.h"
#include "flight/export/trajectory_file.h"
#include "flight/export/wpml_file.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/place/world.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Between the rows of trajectory files [s].
constexpr double trajectory_interval = 0.1;

constexpr std::array<FormatInfo, 9> all_formats{{
    {Format::plan, "plan", ".plan", "above take-off; home above mean sea level"},
    {Format::waypoints, "waypoints", ".waypoints", "above take-off"},
    {Format::kmz, "kmz", ".kmz", "above take-off"},
    {Format::kml, "kml", ".kml", "above mean sea level"},
    {Format::geojson, "geojson", ".geojson", "above the WGS84 ellipsoid"},
    {Format::litchi, "litchi", ".litchi.csv", "above take-off"},
    {Format::csv, "csv", ".csv", "local frame"},
    {Format::ned_csv, "ned-csv", ".ned.csv", "local frame, down"},
    {Format::tum, "tum", ".tum", "local frame"},
}};

std::vector<TimedState> states_of(const FlightPlan& plan) {
  return trajectory(plan, trajectory_interval);
}

/// The route as written, for formats with places on the Earth.
RouteFile route_file(const std::string& content, Format format) {
  switch (format) {
    case Format::plan:
      return route_of(read_plan(content).items);
    case Format::waypoints:
      return route_of(read_waypoints(content).items);
    case Format::kmz:
      return read_kmz(content);
    case Format::kml:
      return read_kml(content);
    case Format::geojson:
      return read_geojson(content);
    default:
      return read_litchi(content);
  }
}

}  // namespace

std::span<const FormatInfo> formats() { return all_formats; }

const FormatInfo& format_info(Format format) {
  return *std::ranges::find(all_formats, format, &FormatInfo::format);
}

Format format_named(const std::string& name) {
  std::string names;
  for (const FormatInfo& info : all_formats) {
    if (name == info.name) return info.format;
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  throw Error(ErrorKind::bad_usage, "format \"" + name + "\" is not known; there are " + names);
}

bool holds_curves(Format format) {
  return format == Format::csv || format == Format::ned_csv || format == Format::tum ||
         format == Format::kml;
}

std::string write(const FlightPlan& plan, Format format) {
  switch (format) {
    case Format::plan:
      return write_plan(plan);
    case Format::waypoints:
      return write_waypoints(plan);
    case Format::kmz:
      return write_kmz(plan);
    case Format::kml:
      return write_kml(plan);
    case Format::geojson:
      return write_geojson(plan);
    case Format::litchi:
      return write_litchi(plan);
    case Format::csv:
      return write_trajectory_csv(states_of(plan), Frame::enu);
    case Format::ned_csv:
      return write_trajectory_csv(states_of(plan), Frame::ned);
    case Format::tum:
      return write_tum(camera_poses(states_of(plan)));
  }
  return {};
}

std::vector<std::string> notes_of(const FlightPlan& plan, Format format) {
  std::vector<std::string> notes;
  if (format == Format::plan) {
    for (const std::string& name : flat_no_fly(plan).left_out) {
      notes.push_back("no-fly volume \"" + name +
                      "\" is passed over or under; the format has no heights, so it is left out");
    }
  }
  if (format == Format::litchi) {
    notes.emplace_back(
        "Litchi's mission settings are not in the file: set heading mode \"Custom\" and path mode "
        "\"Straight Lines\"; gimbal pitch is in whole degrees");
  }
  return notes;
}

Problems validate(const std::string& content, Format format) {
  switch (format) {
    case Format::plan:
      return validate_plan(content);
    case Format::waypoints:
      return validate_waypoints(content);
    case Format::kmz:
      return validate_kmz(content);
    case Format::kml:
      return validate_kml(content);
    case Format::geojson:
      return validate_geojson(content);
    case Format::litchi:
      return validate_litchi(content);
    case Format::csv:
    case Format::ned_csv:
      return validate_trajectory_csv(content);
    case Format::tum:
      return validate_tum(content);
  }
  return {};
}

std::vector<Vector3d> places_of(const std::string& content, Format format, const Site& site,
                                const Vector3d& pad) {
  std::vector<Vector3d> points;
  if (format == Format::csv || format == Format::ned_csv) {
    for (const TimedState& state : read_trajectory_csv(content)) points.push_back(state.position);
  } else if (format == Format::tum) {
    for (const TimedPose& pose : read_tum(content)) {
      points.emplace_back(pose.world_from_camera.translation());
    }
  } else {
    points = local_points(route_file(content, format), site, pad);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    geometry::require_place(points[i], "place " + std::to_string(i + 1));
  }
  return points;
}

Format format_of_file(const std::filesystem::path& path, const std::string& content) {
  const std::string name = path.filename().string();
  if (path.extension() == ".csv") {
    return content.starts_with("latitude,") ? Format::litchi : Format::csv;
  }
  if (path.extension() == ".txt") return Format::waypoints;
  for (const FormatInfo& info : all_formats) {
    if (name.ends_with(info.ending)) return info.format;
  }
  throw Error(ErrorKind::bad_file, path.string() +
                                       " is no route file: its name must end in .plan, .waypoints, "
                                       ".txt, .kmz, .kml, .geojson, .csv or .tum");
}

std::vector<Vector3d> read_route(const std::filesystem::path& path, const Site& site,
                                 const Vector3d& pad) {
  const std::string content = geometry::read_file(path, largest_route_file);
  const Format format = format_of_file(path, content);
  try {
    return places_of(content, format, site, pad);
  } catch (const Error& error) {
    throw Error(error.kind(), path.string() + ": " + error.what());
  }
}

std::optional<double> read_return_height(const std::filesystem::path& path) {
  const std::string content = geometry::read_file(path);
  if (format_of_file(path, content) != Format::kmz) return std::nullopt;
  return read_kmz(content).return_height;
}

}  // namespace skycap::flight
