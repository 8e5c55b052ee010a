#include "flight/export/export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "flight/export/map_files.h"
#include "flight/export/mavlink_files.h"
#include "flight/export/trajectory_file.h"
#include "flight/export/wpml_file.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/pose/world.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Format with its functions.
struct FormatRecord {
  FormatInfo info;
  bool is_local = false;
  bool supports_curves = false;
  bool captures_images = false;
  bool holds_photo_runs = false;
  std::string (*write)(const FlightPlan& plan) = nullptr;
  Problems (*validate)(const std::string& content) = nullptr;
  /// Returns positions in the local frame [m], in file order.
  std::vector<Vector3d> (*read_positions)(const std::string& content, const Site& site,
                                          const Vector3d& pad) = nullptr;
  /// Returns notes on omitted data.
  std::vector<std::string> (*notes)(const FlightPlan& plan) = nullptr;
};

/// Interval between rows of trajectory files [s].
constexpr double trajectory_interval = 0.1;

std::vector<TimedState> compute_states(const FlightPlan& plan) {
  return trajectory(plan, trajectory_interval);
}

/// Returns the local positions of a file with geodetic coordinates.
template <class Read>
std::vector<Vector3d> geodetic_positions(const std::string& content, const Site& site,
                                         const Vector3d& pad, const Read& read) {
  return local_points(read(content), site, pad);
}

std::vector<Vector3d> csv_positions(const std::string& content, const Site&, const Vector3d&) {
  std::vector<Vector3d> points;
  for (const TimedState& state : read_trajectory_csv(content)) points.push_back(state.position);
  return points;
}

std::vector<Vector3d> tum_positions(const std::string& content, const Site&, const Vector3d&) {
  std::vector<Vector3d> points;
  for (const TimedPose& pose : read_tum(content)) {
    points.emplace_back(pose.world_from_camera.translation());
  }
  return points;
}

std::vector<std::string> make_plan_notes(const FlightPlan& plan) {
  std::vector<std::string> notes;
  for (const std::string& name : flat_no_fly(plan).left_out) {
    notes.push_back(
        "no-fly volume \"" + name +
        "\" is omitted: the route passes over or under it, and the format cannot store heights");
  }
  return notes;
}

std::vector<std::string> make_litchi_notes(const FlightPlan&) {
  return {
      "Litchi's mission settings are not in the file: set heading mode \"Custom\" and path mode "
      "\"Straight Lines\"; the gimbal pitch is rounded to whole degrees"};
}

/// All formats, in the order of Format. A new format requires a row here, an enumerator with its
/// case in is_format(), and a source file with its writer, reader and checks.
constexpr auto records = std::to_array<FormatRecord>({
    {.info = {Format::plan, "plan", ".plan", "above take-off; home above mean sea level"},
     .captures_images = true,
     .holds_photo_runs = true,
     .write = write_plan,
     .validate = [](const std::string& content) { return validate_plan(content); },
     .read_positions =
         [](const auto& content, const auto& site, const auto& pad) {
           return geodetic_positions(content, site, pad, [](const auto& text) {
             return make_route(read_plan(text).items);
           });
         },
     .notes = make_plan_notes},
    {.info = {Format::waypoints, "waypoints", ".waypoints", "above take-off"},
     .captures_images = true,
     .holds_photo_runs = true,
     .write = write_waypoints,
     .validate = [](const std::string& content) { return validate_waypoints(content); },
     .read_positions =
         [](const auto& content, const auto& site, const auto& pad) {
           return geodetic_positions(content, site, pad, [](const auto& text) {
             return make_route(read_waypoints(text).items);
           });
         }},
    {.info = {Format::kmz, "kmz", ".kmz", "above take-off"},
     .captures_images = true,
     .holds_photo_runs = true,
     .write = write_kmz,
     .validate = validate_kmz,
     .read_positions =
         [](const auto& content, const auto& site, const auto& pad) {
           return geodetic_positions(content, site, pad,
                                     [](const auto& text) { return read_kmz(text); });
         }},
    {.info = {Format::kml, "kml", ".kml", "above mean sea level"},
     .supports_curves = true,
     .write = write_kml,
     .validate = validate_kml,
     .read_positions =
         [](const auto& content, const auto& site, const auto& pad) {
           return geodetic_positions(content, site, pad, read_kml);
         }},
    {.info = {Format::geojson, "geojson", ".geojson", "above the WGS84 ellipsoid"},
     .write = write_geojson,
     .validate = validate_geojson,
     .read_positions =
         [](const auto& content, const auto& site, const auto& pad) {
           return geodetic_positions(content, site, pad, read_geojson);
         }},
    {.info = {Format::litchi, "litchi", ".litchi.csv", "above take-off"},
     .captures_images = true,
     .write = write_litchi,
     .validate = validate_litchi,
     .read_positions =
         [](const auto& content, const auto& site,
            const auto& pad) { return geodetic_positions(content, site, pad, read_litchi); },
     .notes = make_litchi_notes},
    {.info = {Format::csv, "csv", ".csv", "local frame"},
     .is_local = true,
     .supports_curves = true,
     .write = [](const FlightPlan&
                     plan) { return write_trajectory_csv(compute_states(plan), Frame::enu); },
     .validate = validate_trajectory_csv,
     .read_positions = csv_positions},
    {.info = {Format::ned_csv, "ned-csv", ".ned.csv", "local frame, down"},
     .is_local = true,
     .supports_curves = true,
     .write = [](const FlightPlan&
                     plan) { return write_trajectory_csv(compute_states(plan), Frame::ned); },
     .validate = validate_trajectory_csv,
     .read_positions = csv_positions},
    {.info = {Format::tum, "tum", ".tum", "local frame"},
     .is_local = true,
     .supports_curves = true,
     .write = [](const FlightPlan& plan) { return write_tum(camera_poses(compute_states(plan))); },
     .validate = validate_tum,
     .read_positions = tum_positions},
});

/// Whether a number is that of a format. The compiler rejects a format without a case.
#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wswitch"
constexpr bool is_format(Format format) {
  switch (format) {
    case Format::plan:
    case Format::waypoints:
    case Format::kmz:
    case Format::kml:
    case Format::geojson:
    case Format::litchi:
    case Format::csv:
    case Format::ned_csv:
    case Format::tum:
      return true;
  }
  return false;
}
#pragma GCC diagnostic pop

constexpr bool has_row_for_each_format() {
  for (std::size_t i = 0; i < records.size(); ++i) {
    const FormatRecord& record = records[i];
    if (record.info.format != static_cast<Format>(i)) return false;
    if (record.write == nullptr || record.validate == nullptr || record.read_positions == nullptr) {
      return false;
    }
  }
  return !is_format(static_cast<Format>(records.size()));
}
static_assert(
    has_row_for_each_format(),
    "records: one row for each Format, in the same order, with writer, checks and reader");

const FormatRecord& find_record(Format format) {
  return records.at(static_cast<std::size_t>(format));
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

const FormatInfo& format_info(Format format) { return find_record(format).info; }

Format format_named(const std::string& name) {
  std::string names;
  for (const FormatInfo& info : formats()) {
    if (name == info.name) return info.format;
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  throw Error(ErrorKind::bad_usage, "unknown format \"" + name + "\"; expected one of: " + names);
}

bool is_local(Format format) { return find_record(format).is_local; }

bool supports_curves(Format format) { return find_record(format).supports_curves; }

bool captures_images(Format format) { return find_record(format).captures_images; }

bool holds_photo_runs(Format format) { return find_record(format).holds_photo_runs; }

std::vector<FlightPlan> split_plan(const FlightPlan& plan, Format format) {
  return format == Format::litchi ? litchi_parts(plan) : std::vector{plan};
}

std::string write(const FlightPlan& plan, Format format) { return find_record(format).write(plan); }

std::vector<std::string> make_notes(const FlightPlan& plan, Format format) {
  const FormatRecord& record = find_record(format);
  return record.notes != nullptr ? record.notes(plan) : std::vector<std::string>();
}

Problems validate(const std::string& content, Format format) {
  return find_record(format).validate(content);
}

std::vector<Vector3d> read_positions(const std::string& content, Format format, const Site& site,
                                     const Vector3d& pad) {
  std::vector<Vector3d> points = find_record(format).read_positions(content, site, pad);
  for (std::size_t i = 0; i < points.size(); ++i) {
    geometry::require_valid_position(points[i], "place " + std::to_string(i + 1));
  }
  return points;
}

Format detect_format(const std::filesystem::path& path, const std::string& content) {
  const std::string name = path.filename().string();
  if (path.extension() == ".csv") {
    return geometry::without_mark(content).starts_with("latitude,") ? Format::litchi : Format::csv;
  }
  if (path.extension() == ".txt") return Format::waypoints;
  for (const FormatInfo& info : formats()) {
    if (name.ends_with(info.extension)) return info.format;
  }
  std::string extensions;
  for (const FormatInfo& info : formats()) extensions += std::string(info.extension) + ", ";
  throw Error(ErrorKind::bad_file, path.string() + " is not a route file: its name must end in " +
                                       extensions + "or .txt");
}

std::vector<Vector3d> read_route(const std::filesystem::path& path, const Site& site,
                                 const Vector3d& pad) {
  const std::string content = geometry::read_file(path, largest_route_file);
  const Format format = detect_format(path, content);
  try {
    return read_positions(content, format, site, pad);
  } catch (const Error& error) {
    throw Error(error.kind(), path.string() + ": " + error.what());
  }
}

std::optional<double> read_return_height(const std::filesystem::path& path) {
  const std::string content = geometry::read_file(path);
  if (detect_format(path, content) != Format::kmz) return std::nullopt;
  return read_kmz(content).return_height;
}

}  // namespace skycap::flight
