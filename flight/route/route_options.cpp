#include <algorithm>
#include <cmath>
#include <numbers>

#include "flight/route/route.h"
#include "geometry/error.h"

namespace skycap::flight {

double yaw_of(const geometry::View& view) {
  if (view.direction.head<2>().norm() < 1e-9) return 0.0;
  const double yaw = std::atan2(view.direction.x(), view.direction.y());
  return yaw < 0.0 ? yaw + 2.0 * std::numbers::pi : yaw;
}

double pitch_of(const geometry::View& view) {
  return std::asin(std::clamp(view.direction.z() / view.direction.norm(), -1.0, 1.0));
}

bool can_look(const Vehicle& vehicle, const geometry::View& view) {
  constexpr double rounding = 1e-6;  // [rad]
  const double pitch = pitch_of(view);
  return pitch >= vehicle.gimbal_min - rounding && pitch <= vehicle.gimbal_max + rounding;
}

void ClearanceBudget::validate() const {
  const auto require = [](double value, const char* field) {
    if (value >= 0.0 && std::isfinite(value)) return;
    throw Error(ErrorKind::bad_config, "clearance." + std::string(field) + " is " +
                                           std::to_string(value) +
                                           " m; it must be a finite number, zero or more");
  };
  require(vehicle_radius, "vehicle_radius"), require(position_error, "position_error");
  require(tracking_error, "tracking_error"), require(map_error, "map_error");
  require(margin, "margin");
}

void RouteOptions::validate() const {
  clearance.validate();
  path.validate();
  if (!takeoff.allFinite()) {
    throw Error(ErrorKind::bad_config, "the take-off place is not a finite position");
  }
  if (!(takeoff_climb >= 0.0) || !std::isfinite(takeoff_climb)) {
    throw Error(ErrorKind::bad_config, "the climb after take-off is " +
                                           std::to_string(takeoff_climb) +
                                           " m; it must be a finite number, zero or more");
  }
}

}  // namespace skycap::flight
