#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "flight/route/route.h"
#include "geometry/error.h"
#include "geometry/requirement.h"

namespace skycap::flight {

Eigen::Vector3d compute_direction(const Aim& aim) {
  return {std::cos(aim.pitch) * std::sin(aim.yaw), std::cos(aim.pitch) * std::cos(aim.yaw),
          std::sin(aim.pitch)};
}

double compute_yaw(const geometry::View& view) {
  if (view.direction.head<2>().norm() < 1e-9) return 0.0;
  const double yaw = std::atan2(view.direction.x(), view.direction.y());
  return yaw < 0.0 ? yaw + 2.0 * std::numbers::pi : yaw;
}

double compute_pitch(const geometry::View& view) {
  return std::asin(std::clamp(view.direction.z() / view.direction.norm(), -1.0, 1.0));
}

bool can_aim(const Vehicle& vehicle, const geometry::View& view) {
  constexpr double rounding = 1e-6;  // [rad].
  const double pitch = compute_pitch(view);
  return pitch >= vehicle.gimbal_min - rounding && pitch <= vehicle.gimbal_max + rounding;
}

void ClearanceBudget::validate() const {
  for (const auto& [value, field] : {std::pair(vehicle_radius, "vehicle_radius"),
                                     {position_error, "position_error"},
                                     {tracking_error, "tracking_error"},
                                     {map_error, "map_error"},
                                     {margin, "margin"}}) {
    require(value >= 0.0 && std::isfinite(value), std::string("clearance.") + field, value,
            "a finite number of metres, zero or more");
  }
}

RtlProfile planning_rtl_profile(const RouteOptions& options, double top) {
  /// Exceeds the subdivision of proofs and the rounding of positions in files.
  constexpr double reserve = 0.25;
  const ReturnOptions& asked = options.returns.value();
  const double ground = options.takeoff.z();
  RtlProfile rtl_profile{.autopilots = asked.autopilots,
                         .level = std::max(ground + std::floor(asked.max_height - ground), top),
                         .landings = {options.takeoff},
                         .landing_climb = options.takeoff_climb,
                         .reserve = reserve,
                         .braking = asked.braking};
  rtl_profile.landings.insert(rtl_profile.landings.end(), asked.rally.begin(), asked.rally.end());
  return rtl_profile;
}

void RouteOptions::validate() const {
  clearance.validate();
  path.validate();
  if (!takeoff.allFinite()) {
    throw Error(ErrorKind::bad_config, "the take-off point has a non-finite position");
  }
  if (!(takeoff_climb >= 0.0) || !std::isfinite(takeoff_climb)) {
    throw Error(ErrorKind::bad_config, "the climb after take-off is " +
                                           std::to_string(takeoff_climb) +
                                           " m; it must be a finite number, zero or more");
  }
}

}  // namespace skycap::flight
