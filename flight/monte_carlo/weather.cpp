#include "flight/monte_carlo/weather.h"

#include <algorithm>
#include <cmath>

namespace skycap::flight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double feet_per_metre = 3.280839895;
/// Correlation time of receivers with corrections [s].
constexpr double receiver_time = 60.0;

/// Decay factor of a first-order process and standard deviation of its innovation over one step.
struct Decay {
  double kept, added;
};

Decay compute_decay(double step, double time) {
  const double kept = std::exp(-step / time);
  return {kept, std::sqrt(1.0 - kept * kept)};
}

}  // namespace

Vector3d Weather::next(double step, double height, double airspeed) {
  const double speed = wind_.norm();
  if (speed == 0.0) return Vector3d::Zero();
  // MIL-F-8785C, equations for h below 1000 ft. Lengths and heights are in feet.
  const double h = std::clamp(height * feet_per_metre, 10.0, 1000.0);
  const double shape = 0.177 + 0.000823 * h;
  const double sigma_up = 0.1 * speed, sigma_level = sigma_up / std::pow(shape, 0.4);
  const Vector3d sigma(sigma_level, sigma_level, sigma_up);
  const double length_level = h / std::pow(shape, 1.2) / feet_per_metre;
  const Vector3d length(length_level, length_level, h / feet_per_metre);
  for (int axis = 0; axis < 3; ++axis) {
    const auto [kept, added] = compute_decay(step, length[axis] / std::max(airspeed, 1.0));
    const double strength = has_begun_ ? added : 1.0;
    gust_[axis] =
        (has_begun_ ? kept * gust_[axis] : 0.0) + strength * sigma[axis] * random_.normal();
  }
  has_begun_ = true;
  const Vector2d along = wind_ / speed, across(-along.y(), along.x());
  const Vector2d level = wind_ + gust_.x() * along + gust_.y() * across;
  return {level.x(), level.y(), gust_.z()};
}

Vector3d ReceiverError::next(double step) {
  const double sigma = bound_ / 3.0;
  const auto [kept, added] = compute_decay(step, receiver_time);
  for (int axis = 0; axis < 3; ++axis) {
    const double strength = has_begun_ ? added : 1.0;
    error_[axis] = (has_begun_ ? kept * error_[axis] : 0.0) + strength * sigma * random_.normal();
  }
  has_begun_ = true;
  const double size = error_.norm();
  return size > bound_ ? Vector3d(error_ * (bound_ / size)) : error_;
}

}  // namespace skycap::flight
