#include "flight/monte_carlo/vehicle_model.h"

#include <algorithm>
#include <cmath>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double position_gain = 1.0;  ///< Proportional gain of the position error [1/s].
constexpr double velocity_gain = 2.0;  ///< Proportional gain of the velocity error [1/s].
constexpr double sum_gain = 0.8;       ///< Integral gain of the velocity error [1/s^2].
constexpr double lag = 0.15;           ///< Lag of thrust and tilt [s].
/// Maximum horizontal acceleration, at a tilt of 35 degrees [m/s^2].
constexpr double max_horizontal_acceleration = 6.9;
constexpr double max_vertical_acceleration = 5.0;  ///< Maximum vertical acceleration [m/s^2].
/// Maximum velocity correction for a position error [m/s].
constexpr double max_correction = 2.0;

Vector3d limited(const Vector3d& acceleration) {
  Vector3d result = acceleration;
  const double level = acceleration.head<2>().norm();
  if (level > max_horizontal_acceleration) result.head<2>() *= max_horizontal_acceleration / level;
  result.z() = std::clamp(result.z(), -max_vertical_acceleration, max_vertical_acceleration);
  return result;
}

}  // namespace

Vector3d VehicleModel::drag(const Vector3d& air) const {
  const Vehicle& vehicle = motion_.vehicle();
  const Vector3d through = velocity_ - air;
  const double factor =
      0.5 * motion_.conditions().air_density * vehicle.drag_area / vehicle.mass * through.norm();
  return -factor * through;
}

void VehicleModel::fly(const SetPoint& target, const Vector3d& error, const Vector3d& air,
                       double step) {
  Vector3d correction = position_gain * (target.position - (position_ + error));
  const double size = correction.norm();
  if (size > max_correction) correction *= max_correction / size;
  const Vector3d velocity_error = target.velocity + correction - velocity_;
  const Vector3d asked = target.acceleration + velocity_gain * velocity_error + sum_;
  const Vector3d allowed = limited(asked);
  // Errors beyond the limits are not integrated, because they would cause an overshoot.
  if (allowed == asked) sum_ += sum_gain * step * velocity_error;
  thrust_ += (1.0 - std::exp(-step / lag)) * (allowed - thrust_);

  const double speed_before = velocity_.norm();
  velocity_ += step * (thrust_ + drag(air));
  position_ += step * velocity_;
  const Vector3d wind(motion_.conditions().wind.x(), motion_.conditions().wind.y(), 0.0);
  energy_ += step * motion_.flight_power(velocity_ - air + wind);
  const double gained =
      motion_.stopping_energy(velocity_.norm()) - motion_.stopping_energy(speed_before);
  energy_ += std::max(0.0, gained);
}

}  // namespace skycap::flight
