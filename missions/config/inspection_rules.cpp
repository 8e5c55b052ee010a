#include "missions/config/inspection_rules.h"

#include <algorithm>
#include <string>

#include "geometry/angle.h"
#include "missions/config/derived_values.h"

namespace skycap::missions::config {
namespace {

using geometry::radians_per_degree;

void check_without_range(const MissionDocument& document) {
  for (const auto& [key, position] : document.locations) {
    if (!key.starts_with("inspection.")) continue;
    document.reject(key,
                    "requires inspection.range; set it to the maximum view distance in "
                    "metres, or remove the key");
  }
}

/// Sets a limit to its default, or to the vehicle's limit if that is less.
void complete_limit(const MissionDocument& document, const char* key, double usual,
                    double of_vehicle, std::optional<double>& limit) {
  if (!limit) limit = std::min(usual, of_vehicle);
  constexpr double rounding = 1.0 + 1e-9;
  if (*limit > of_vehicle * rounding) {
    document.reject(key, "must be at most the limit of the vehicle '" +
                             document.flight.options.vehicle_name + "'; lower it");
  }
}

}  // namespace

void check_inspection(const MissionDocument& document) {
  if (!document.is_inspection()) return check_without_range(document);
  if (!document.flight.has_vehicle()) {
    document.reject("inspection.range",
                    "requires a vehicle, whose limits the flight keeps; set flight.vehicle");
  }
  if (document.sensor.lidar) {
    document.reject("sensor.lidar",
                    "conflicts with inspection.range, which requires a camera; remove one of the "
                    "two");
  }
  if (!document.flight.options.fleet.names.empty()) {
    document.reject("flight.vehicles",
                    "conflicts with inspection.range, which plans for one vehicle; set "
                    "flight.vehicle instead");
  }
  for (const auto& [key, position] : document.locations) {
    if (!key.starts_with("photo.")) continue;
    document.reject(key,
                    "conflicts with inspection.range, which plans a continuous flight; "
                    "remove one of the two");
  }
  if (!document.inspection.cloud && !has_target(document)) {
    document.reject("inspection.range",
                    "requires a structure whose shape is known; set inspection.cloud to a point "
                    "cloud, or add prior data with role: target");
  }
  if (document.flight.free_space != FreeSpaceRule::assumed) {
    document.reject("inspection.range",
                    "requires flight.free_space: assumed, because nothing measures the space "
                    "around the structure; set it, and check the airspace on site");
  }
}

void complete_inspection(MissionDocument& document) {
  if (!document.is_inspection()) return;
  InspectionSection& inspection = document.inspection;
  const flight::Vehicle& vehicle = document.flight.options.required_vehicle();
  constexpr double speed = 2.0, acceleration = 1.0, jerk = 0.5;
  complete_limit(document, "inspection.max_speed", speed, vehicle.max_speed, inspection.max_speed);
  complete_limit(document, "inspection.max_acceleration", acceleration,
                 std::min(vehicle.mode.acceleration, vehicle.mode.vertical_acceleration),
                 inspection.max_acceleration);
  complete_limit(document, "inspection.max_jerk", jerk, vehicle.mode.jerk, inspection.max_jerk);
  constexpr double yaw_rate = 60.0 * radians_per_degree;
  constexpr double yaw_acceleration = 30.0 * radians_per_degree;
  complete_limit(document, "inspection.max_yaw_rate_deg", yaw_rate, vehicle.mode.yaw_rate,
                 inspection.max_yaw_rate);
  complete_limit(document, "inspection.max_yaw_acceleration_deg", yaw_acceleration,
                 vehicle.mode.yaw_acceleration, inspection.max_yaw_acceleration);
  constexpr double spacings = 40.0, typical_share = 0.7;
  if (!inspection.spacing) inspection.spacing = *inspection.range / spacings;
  if (!document.planner.sampling.view_distance) {
    document.planner.sampling.view_distance = typical_share * *inspection.range;
  }
}

survey::inspection::InspectionOptions inspection_options(const MissionDocument& document) {
  const InspectionSection& inspection = document.inspection;
  const flight::FlightOptions flight = flight_options(document);
  const flight::Vehicle& vehicle = flight.required_vehicle();
  survey::inspection::InspectionOptions options;
  const geometry::CameraConfig& camera = document.sensor.options.camera.camera;
  options.camera.horizontal_fov = camera.horizontal_fov;
  options.camera.vertical_fov = camera.vertical_fov;
  options.camera.width = camera.width;
  options.camera.height = camera.height;
  options.camera.range = inspection.range.value();
  options.camera.max_incidence = inspection.max_incidence;
  options.limits.speed = inspection.max_speed.value();
  options.limits.acceleration = inspection.max_acceleration.value();
  options.limits.jerk = inspection.max_jerk.value();
  options.limits.yaw_rate = inspection.max_yaw_rate.value();
  options.limits.yaw_acceleration = inspection.max_yaw_acceleration.value();
  options.limits.pitch_rate = vehicle.gimbal_rate;
  options.limits.ascent = vehicle.mode.max_ascent;
  options.limits.descent = vehicle.mode.max_descent;
  options.goal.shares = {0.0, 0.0, inspection.share};
  options.goal.min_views = inspection.min_views;
  const survey::ViewLimits limits = view_limits(document);
  options.pitch = {limits.min_pitch, limits.max_pitch};
  options.clearance = flight.budget().total();
  options.moves = static_cast<std::size_t>(inspection.moves);
  options.searches = static_cast<std::size_t>(inspection.searches);
  return options;
}

}  // namespace skycap::missions::config
