#include "flight/export/export.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "flight/export/map_files.h"
#include "flight/export/mavlink_files.h"
#include "flight/export/trajectory_file.h"
#include "flight/export/wpml_file.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/place/world.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Format with its functions.
struct FormatRecord {
  FormatInfo info;
  bool holds_curves = false;
  std::string (*write)(const FlightPlan& plan);
  Problems (*validate)(const std::string& content);
  /// Returns positions in the local frame [m], in file order.
  std::vector<Vector3d> (*places)(const std::string& content, const Site& site,
                                  const Vector3d& pad);
  /// Returns notes on omitted data.
  std::vector<std::string> (*notes)(const FlightPlan& plan) = nullptr;
};

/// Interval between rows of trajectory files [s].
constexpr double trajectory_interval = 0.1;

std::vector<TimedState> states_of(const FlightPlan& plan) {
  return trajectory(plan, trajectory_interval);
}

/// Returns the local positions of a file with geodetic coordinates.
template <class Read>
std::vector<Vector3d> earth_places(const std::string& content, const Site& site,
                                   const Vector3d& pad, const Read& read) {
  return local_points(read(content), site, pad);
}

std::vector<Vector3d> csv_places(const std::string& content, const Site&, const Vector3d&) {
  std::vector<Vector3d> points;
  for (const TimedState& state : read_trajectory_csv(content)) points.push_back(state.position);
  return points;
}

std::vector<Vector3d> tum_places(const std::string& content, const Site&, const Vector3d&) {
  std::vector<Vector3d> points;
  for (const TimedPose& pose : read_tum(content)) {
    points.emplace_back(pose.world_from_camera.translation());
  }
  return points;
}

std::vector<std::string> notes_of_plan(const FlightPlan& plan) {
  std::vector<std::string> notes;
  for (const std::string& name : flat_no_fly(plan).left_out) {
    notes.push_back(
        "no-fly volume \"" + name +
        "\" is left out: the route passes over or under it, and the format has no heights");
  }
  return notes;
}

std::vector<std::string> notes_of_litchi(const FlightPlan&) {
  return {
      "Litchi's mission settings are not in the file: set heading mode \"Custom\" and path mode "
      "\"Straight Lines\"; the gimbal pitch has whole degrees"};
}

/// All formats, in the order of Format. A new format requires a row here, an enumerator, and a
/// source file with its writer, reader and checks.
const std::array<FormatRecord, 9> records{{
    {.info = {Format::plan, "plan", ".plan", "above take-off; home above mean sea level"},
     .write = write_plan,
     .validate = [](const std::string& content) { return validate_plan(content); },
     .places =
         [](const auto& content, const auto& site, const auto& pad) {
           return earth_places(content, site, pad,
                               [](const auto& text) { return route_of(read_plan(text).items); });
         },
     .notes = notes_of_plan},
    {.info = {Format::waypoints, "waypoints", ".waypoints", "above take-off"},
     .write = write_waypoints,
     .validate = [](const std::string& content) { return validate_waypoints(content); },
     .places =
         [](const auto& content, const auto& site, const auto& pad) {
           return earth_places(content, site, pad, [](const auto& text) {
             return route_of(read_waypoints(text).items);
           });
         }},
    {.info = {Format::kmz, "kmz", ".kmz", "above take-off"},
     .write = write_kmz,
     .validate = validate_kmz,
     .places =
         [](const auto& content, const auto& site, const auto& pad) {
           return earth_places(content, site, pad, [](const auto& text) { return read_kmz(text); });
         }},
    {.info = {Format::kml, "kml", ".kml", "above mean sea level"},
     .holds_curves = true,
     .write = write_kml,
     .validate = validate_kml,
     .places = [](const auto& content, const auto& site,
                  const auto& pad) { return earth_places(content, site, pad, read_kml); }},
    {.info = {Format::geojson, "geojson", ".geojson", "above the WGS84 ellipsoid"},
     .write = write_geojson,
     .validate = validate_geojson,
     .places = [](const auto& content, const auto& site,
                  const auto& pad) { return earth_places(content, site, pad, read_geojson); }},
    {.info = {Format::litchi, "litchi", ".litchi.csv", "above take-off"},
     .write = write_litchi,
     .validate = validate_litchi,
     .places = [](const auto& content, const auto& site,
                  const auto& pad) { return earth_places(content, site, pad, read_litchi); },
     .notes = notes_of_litchi},
    {.info = {Format::csv, "csv", ".csv", "local frame"},
     .holds_curves = true,
     .write =
         [](const FlightPlan& plan) { return write_trajectory_csv(states_of(plan), Frame::enu); },
     .validate = validate_trajectory_csv,
     .places = csv_places},
    {.info = {Format::ned_csv, "ned-csv", ".ned.csv", "local frame, down"},
     .holds_curves = true,
     .write =
         [](const FlightPlan& plan) { return write_trajectory_csv(states_of(plan), Frame::ned); },
     .validate = validate_trajectory_csv,
     .places = csv_places},
    {.info = {Format::tum, "tum", ".tum", "local frame"},
     .holds_curves = true,
     .write = [](const FlightPlan& plan) { return write_tum(camera_poses(states_of(plan))); },
     .validate = validate_tum,
     .places = tum_places},
}};

const FormatRecord& record_of(Format format) {
  const FormatRecord& record = records.at(static_cast<std::size_t>(format));
  assert(record.info.format == format);
  return record;
}

}  // namespace

std::span<const FormatInfo> formats() {
  static const std::array<FormatInfo, records.size()> infos = [] {
    std::array<FormatInfo, records.size()> all{};
    std::ranges::transform(records, all.begin(), &FormatRecord::info);
    return all;
  }();
  return infos;
}

const FormatInfo& format_info(Format format) { return record_of(format).info; }

Format format_named(const std::string& name) {
  std::string names;
  for (const FormatInfo& info : formats()) {
    if (name == info.name) return info.format;
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  throw Error(ErrorKind::bad_usage, "unknown format \"" + name + "\"; expected one of: " + names);
}

bool holds_curves(Format format) { return record_of(format).holds_curves; }

std::string write(const FlightPlan& plan, Format format) { return record_of(format).write(plan); }

std::vector<std::string> notes_of(const FlightPlan& plan, Format format) {
  const FormatRecord& record = record_of(format);
  return record.notes != nullptr ? record.notes(plan) : std::vector<std::string>();
}

Problems validate(const std::string& content, Format format) {
  return record_of(format).validate(content);
}

std::vector<Vector3d> places_of(const std::string& content, Format format, const Site& site,
                                const Vector3d& pad) {
  std::vector<Vector3d> points = record_of(format).places(content, site, pad);
  for (std::size_t i = 0; i < points.size(); ++i) {
    geometry::require_place(points[i], "place " + std::to_string(i + 1));
  }
  return points;
}

Format format_of_file(const std::filesystem::path& path, const std::string& content) {
  const std::string name = path.filename().string();
  if (path.extension() == ".csv") {
    return geometry::without_mark(content).starts_with("latitude,") ? Format::litchi : Format::csv;
  }
  if (path.extension() == ".txt") return Format::waypoints;
  for (const FormatInfo& info : formats()) {
    if (name.ends_with(info.ending)) return info.format;
  }
  throw Error(ErrorKind::bad_file, path.string() +
                                       " is not a route file: its name must end in .plan, "
                                       ".waypoints, .txt, .kmz, .kml, .geojson, .csv or .tum");
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
