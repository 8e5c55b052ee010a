#include "missions/config/site.h"

#include <algorithm>

#include "geometry/place/camera.h"
#include "missions/config/mission_flight.h"
#include "missions/config/mission_priors.h"
#include "missions/config/scanner_field.h"

namespace skycap::missions::config {

std::optional<double> least_view_height(const config::Mission& mission) {
  const std::optional<double>& clearance = mission.limits.ground_clearance;
  return clearance ? std::optional(ground_height_of(mission) + *clearance) : std::nullopt;
}

survey::ViewLimits view_limits(const config::Mission& mission) {
  const config::LimitsConfig& limits = mission.limits;
  survey::ViewLimits result{.least_height = mission.site.lowest_height,
                            .most_height = mission.site.highest_height,
                            .geofence = mission.site.geofence,
                            .no_fly = mission.site.no_fly,
                            .stand_off = limits.stand_off,
                            .least_pitch = limits.lowest_pitch,
                            .most_pitch = limits.highest_pitch};
  if (const std::optional<double> least = least_view_height(mission)) {
    result.least_height = std::max(*least, result.least_height.value_or(*least));
  }
  if (const auto terrain = priors_of(mission).terrain; terrain && limits.ground_clearance) {
    result.least_height_over = [terrain, plane = mission.scene.position.z(),
                                clearance = *limits.ground_clearance](const Eigen::Vector2d& at) {
      return terrain->height(at).value_or(plane) + clearance;
    };
  }
  if (mission.flight.is_flown()) {
    const flight::Vehicle& vehicle = vehicle_of(mission);
    if (!mission.sensor.mount) {  // which is on no gimbal
      result.least_pitch = std::max(result.least_pitch, vehicle.gimbal_min);
      result.most_pitch = std::min(result.most_pitch, vehicle.gimbal_max);
    } else if (kind_of(*mission.sensor.scanner) == ScannerKind::rosette) {
      constexpr double hair = 1e-5;  // less than no way up or down is a limit that nothing keeps
      result.least_pitch = std::max(result.least_pitch, mission.sensor.mount->look_pitch - hair);
      result.most_pitch = std::min(result.most_pitch, mission.sensor.mount->look_pitch + hair);
    }
    result.stand_off = std::max(result.stand_off, mission.flight.clearance);
  }
  return result;
}

double view_distance_of(const config::Mission& mission) {
  const survey::see::SeeConfig& see = mission.planner.see;
  return see.view_distance.value_or(
      geometry::view_distance(geometry::Camera(mission.sensor.camera.camera), see.density));
}

std::optional<geometry::View> given_start(const config::Mission& mission) {
  const config::StartConfig& start = mission.start;
  if (!start.position) return std::nullopt;
  if (start.look_at) return geometry::look_at(*start.position, *start.look_at);
  return geometry::View{*start.position, start.direction->normalized()};
}

}  // namespace skycap::missions::config
