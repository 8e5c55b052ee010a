#include "missions/online/guided/leg_set_points.h"

#include <algorithm>
#include <cmath>

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;

/// Time for which ArduCopter continues with the last velocity (GUID_TIMEOUT) [s].
constexpr double set_point_life = 3.0;
constexpr double reaction = 1.0;     ///< Delay until the vehicle starts to brake [s].
constexpr double min_advance = 0.2;  ///< Two setpoint intervals [s].

}  // namespace

flight::SetPoint with_stopping_speed(const flight::ScriptedLeg& leg, flight::SetPoint point) {
  const double left = (leg.to - point.position).norm(), speed = point.velocity.norm();
  // Solves t v + v^2 / (2 a) = left: flight at constant speed, then braking.
  constexpr double t = set_point_life + reaction;
  const double max = leg.acceleration * (std::sqrt(t * t + 2.0 * left / leg.acceleration) - t);
  if (speed > max) point.velocity *= max / speed;
  return point;
}

double time_after(const flight::ScriptedLeg& leg, double jerk, double time,
                  const flight::SetPoint& sent, double late) {
  if (late <= min_advance) return time + late;
  const double led = std::min(late, set_point_life);
  const double reached = (sent.position - leg.from).norm() + led * sent.velocity.norm();
  double low = time + min_advance, high = time + led;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    const Vector3d braking_point = flight::set_point(leg, jerk, middle).position;
    ((braking_point - leg.from).norm() <= reached ? low : high) = middle;
  }
  return low;
}

Vector3d stopping_point(const flight::Segment& leg, const Vector3d& position,
                        const Vector3d& velocity, double acceleration) {
  const Vector3d displacement = leg.to - leg.from;
  const double length = displacement.norm();
  if (length == 0.0) return leg.to;
  const Vector3d direction = displacement / length;
  const double speed = std::max(0.0, velocity.dot(direction));
  const double along = (position - leg.from).dot(direction) + 0.5 * speed * speed / acceleration;
  return leg.from + std::clamp(along, 0.0, length) * direction;
}

}  // namespace skycap::missions::online
