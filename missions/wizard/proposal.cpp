#include "missions/wizard/proposal.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/error.h"
#include "missions/config/resolve.h"
#include "missions/config/sensor_reader.h"
#include "missions/config/vehicle_reader.h"
#include "missions/wizard/pad_search.h"
#include "missions/wizard/target.h"

namespace skycap::missions::wizard {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Minimum margins of the unknown box around the target [m]. Maps have errors, and trees, wires and
/// people near buildings are not in them.
constexpr double unknown_margin = 5.0, unknown_above = 3.0;

double rounded_up(double value, double unit) { return std::ceil(value / unit) * unit; }

/// Returns the coverage distance [m], which increases with the size of the target.
double compute_coverage_distance(const AlignedBox3d& target) {
  return std::clamp(rounded_up(target.sizes().maxCoeff() / 60.0, 0.05), 0.1, 1.0);
}

/// Returns the box enlarged to corners at multiples of `unit`.
AlignedBox3d rounded_out(const AlignedBox3d& box, double unit) {
  return {(box.min().array() / unit).floor() * unit, (box.max().array() / unit).ceil() * unit};
}

AlignedBox3d unknown_box(const AlignedBox3d& target, double uncertainty, bool has_terrain) {
  const double find_pad_beside = std::max(unknown_margin, uncertainty);
  AlignedBox3d box = target;
  box.min().array() -= find_pad_beside;
  box.max().array() += find_pad_beside;
  box.max().z() = target.max().z() + std::max(unknown_above, uncertainty);
  const double foot = std::round(100.0 * target.min().z()) / 100.0;
  box.min().z() = has_terrain ? foot - find_pad_beside : 0.0;
  return rounded_out(box, 1.0);
}

/// Returns a geofence around a box and a pad.
AlignedBox3d fence_around(const AlignedBox3d& unknown, const std::optional<Vector3d>& pad,
                          double view_distance) {
  constexpr double margin = 10.0;
  AlignedBox3d fence = unknown;
  fence.min().array() -= view_distance + margin;
  fence.max().array() += view_distance + margin;
  if (pad)
    fence.extend(
        AlignedBox3d(*pad - Vector3d(margin, margin, 0), *pad + Vector3d(margin, margin, 0)));
  return rounded_out(fence, 1.0);
}

/// The values with the geofence of their view distance.
MissionValues with_fence(MissionValues values) {
  values.fence = fence_around(values.unknown, values.pad, values.view_distance);
  return values;
}

}  // namespace

double compute_min_clearance(const flight::Vehicle& vehicle) {
  constexpr double min_margin = 0.5, unit = 0.5;
  const double margin = std::max(min_margin, flight::stop_overshoot(vehicle));
  const flight::FlightOptions usual;
  const double errors = vehicle.position_error + usual.tracking_error + usual.map_error;
  return rounded_up(vehicle.radius + errors + margin, unit);
}

MissionValues values_for(MissionValues values, const AlignedBox3d& target, double uncertainty,
                         bool has_terrain) {
  values.unknown = unknown_box(target, uncertainty, has_terrain);
  values.clearance = proposed_clearance;
  values.registration_distance = compute_coverage_distance(target);
  values.view_distance = std::round(std::clamp(target.sizes().maxCoeff(), 10.0, 25.0));
  return with_fence(std::move(values));
}

MissionValues with_pad(MissionValues values, const Vector3d& pad) {
  values.pad = pad;
  return with_fence(std::move(values));
}

double compute_max_climb_altitude(const MissionValues& values) {
  return values.fence.max().z() - values.clearance;
}

namespace {

/// The sensor that is asked for, or the vehicle's own camera.
std::string make_sensor(const SiteRequest& request) {
  return request.sensor.empty() ? config::find_vehicle_camera(request.vehicle) : request.sensor;
}

/// The values with a sensor, and the distance that it measures well from.
MissionValues with_sensor(MissionValues values, const std::string& sensor) {
  values.sensor = sensor;
  if (sensor.empty() || is_lidar(sensor)) return values;
  const config::SensorDescription camera = config::find_camera(sensor);
  if (!camera.useful_range) return values;
  values.max_range = camera.useful_range->max;
  values.view_distance = std::min(values.view_distance, 0.9 * camera.useful_range->max);
  return values;
}

/// Beside the target, where heights that count from the take-off point are to be read before there
/// is one. At the height of the ground.
Vector3d provisional_pad(const MissionValues& values) {
  return {values.unknown.max().x() + 10.0, 0.0, 0.0};
}

/// The region of interest from below the target's base, so that no part of its foot is left out.
AlignedBox3d from_below_base(AlignedBox3d scene, const Target& target) {
  constexpr double below = 0.5;
  const double base = target.box.min().z();
  scene.min().z() = std::min(scene.min().z(), base - std::max(below, target.uncertainty));
  return scene;
}

/// The values of a photo mission. An outline is the only knowledge of the shape: two flights.
MissionValues with_photos(MissionValues values, const SiteRequest& request,
                          const flight::Vehicle& vehicle, const Target& target) {
  const site_data::Source& source = values.sources.front();
  const bool is_outline = source.base_on_terrain || source.base;
  values.photo = propose_photos(request.sensor, *request.gsd, vehicle, values.clearance,
                                target.uncertainty, is_outline);
  values.view_distance = values.photo->view_distance;
  return with_fence(std::move(values));
}

/// Maximum horizontal distance of views from the target [m]. Patterns that look down at an angle
/// also start beside a tall target.
double compute_view_reach(const MissionValues& values, const Target& target) {
  if (!values.photo) return values.view_distance;
  return values.view_distance + 0.5 * target.box.sizes().z();
}

}  // namespace

std::string propose_mission(const SiteRequest& request, const std::filesystem::path& file) {
  const std::vector<site_data::Source> files = collect_files(request);
  const Target target = find_target(files, request.target);
  MissionValues values = values_for({.file = file,
                                     .vehicle = request.vehicle,
                                     .sources = select_sources(files, target.ids),
                                     .origin = target.origin,
                                     .sees_neighbours = true,
                                     .unknown = {}},
                                    target.box, target.uncertainty, request.terrain.has_value());
  const flight::Vehicle vehicle = config::find_vehicle(request.vehicle);
  values.clearance = std::max(proposed_clearance, compute_min_clearance(vehicle));
  if (request.gsd) {
    values = with_photos(std::move(values), request, vehicle, target);
  } else {
    values = with_sensor(std::move(values), make_sensor(request));
  }
  if (request.import_options.vertical == site_data::HeightDatum::takeoff) {
    values.pad = provisional_pad(values);
  }
  const config::MissionSetup mission = config::parse_mission(mission_text(values), file.string());
  if (!values.photo) {
    values.scene =
        rounded_out(from_below_base(mission.survey().planner.scene_box.value(), target), 0.1);
  }
  const auto pad = PadSearch(mission.flight())
                       .find_pad_beside(values.unknown, compute_max_climb_altitude(values),
                                        compute_view_reach(values, target));
  if (!pad) {
    throw Error(ErrorKind::bad_config, request.map.string() +
                                           ": no free, level and even take-off point within 100 m "
                                           "of the target; exclude obstacles with select");
  }
  return mission_text(with_pad(std::move(values), *pad));
}

}  // namespace skycap::missions::wizard
