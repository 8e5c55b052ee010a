#include "flight/fleet/fleet_costs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight/motion/flight_time_range.h"
#include "flight/route/leg_costs.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Returns a lower bound on the rest-to-rest time for any path, without settle time. It is the
/// maximum of the bounds along the straight line and vertically, and of the time at full speed.
double min_moving_time(const Motion& motion, const Vector3d& displacement) {
  const double distance = displacement.norm();
  if (distance == 0.0) return 0.0;
  const MissionMode& mode = motion.vehicle().mode;
  const Vector3d direction = displacement / distance;
  const double level = direction.head<2>().norm(), up = std::abs(direction.z());
  const double along =
      rest_to_rest_time(distance, motion.conditions().cruise_speed,
                        level * mode.acceleration + up * mode.vertical_acceleration, mode.jerk);
  const double upright = rest_to_rest_time(
      std::abs(displacement.z()), displacement.z() > 0.0 ? mode.max_ascent : mode.max_descent,
      mode.vertical_acceleration, mode.jerk);
  // The permitted velocities are a convex set, so no detour is faster than the straight line.
  return std::max({along, upright, distance / motion.leg_speed(direction)});
}

double min_leg_time(const Motion& motion, const Vector3d& displacement) {
  if (displacement.isZero(0.0)) return 0.0;
  return min_moving_time(motion, displacement) + motion.vehicle().mode.settle_time;
}

/// Returns a lower bound on the extra time of corner stops, given that a ball of radius `deficit`
/// around a position on the straight line is not free.
double min_corner_time(const Motion& motion, const Vector3d& displacement, double deficit) {
  if (!(deficit > 0.0)) return 0.0;
  const MissionMode& mode = motion.vehicle().mode;
  // Upper bounds on speed and acceleration in any direction. The time is a concave increasing
  // function of distance.
  const auto moving = [&](double distance) {
    return rest_to_rest_time(distance, motion.conditions().cruise_speed,
                             std::hypot(mode.acceleration, mode.vertical_acceleration), mode.jerk);
  };
  // A single corner is at least one ball radius from both ends, and its two pieces are no shorter
  // than the line. Their total time is minimal if one piece is as short as possible.
  const double in_two = moving(deficit) + moving(std::max(deficit, displacement.norm() - deficit));
  const double slower = std::max(0.0, in_two - min_moving_time(motion, displacement));
  const double stop = mode.settle_time + corner_hold;
  return stop + std::min(slower, stop);
}

double deficit(const Segment& line, const FreeSpace& space, double clearance) {
  const LegVerification verification = verify(space, line, clearance, clearance + 1.0);
  if (verification.is_verified) return 0.0;
  return std::max(clearance_guard, clearance - verification.closest.distance);
}

}  // namespace

std::vector<double> leg_clearance_deficits(std::span<const CapturePoint> capture_points,
                                           const FreeSpace& space, double clearance) {
  const std::size_t count = capture_points.size();
  std::vector<double> clearance_deficits(count * count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Segment line{capture_points[i].view.position, capture_points[j].view.position};
      clearance_deficits[i * count + j] = clearance_deficits[j * count + i] =
          deficit(line, space, clearance);
    }
  }
  return clearance_deficits;
}

std::vector<double> return_clearance_deficits(std::span<const CapturePoint> capture_points,
                                              const Vector3d& home, const FreeSpace& space,
                                              double clearance) {
  std::vector<double> clearance_deficits;
  for (const CapturePoint& capture_point : capture_points) {
    clearance_deficits.push_back(deficit({home, capture_point.view.position}, space, clearance));
  }
  return clearance_deficits;
}

FleetVehicle lower_bound_costs(std::span<const CapturePoint> capture_points,
                               const FleetMember& member,
                               const ClearanceDeficits& clearance_deficits) {
  const Motion motion(member.vehicle, member.options.conditions);
  const LegCosts costs(motion);
  const auto leg = [&](const Vector3d& displacement, double deficit, const CapturePoint* from,
                       const CapturePoint* to) {
    const double moving =
        min_leg_time(motion, displacement) + min_corner_time(motion, displacement, deficit);
    const double time = costs.aimed_time(moving, from, to);
    return PartCost{time, motion.leg_energy(displacement, time), 0.0};
  };
  const auto deficit_at = [](const std::vector<double>& list, std::size_t i) {
    return list.empty() ? 0.0 : list[i];
  };
  const double climb = member.options.takeoff_climb;
  FleetVehicle vehicle{.energy_per_sortie = plannable_energy(motion),
                       .capture_points_per_sortie = max_capture_points(motion.vehicle())};
  vehicle.legs.resize(capture_points.size() * capture_points.size());
  for (std::uint32_t i = 0; i < capture_points.size(); ++i) {
    const Vector3d& position = capture_points[i].view.position;
    const Vector3d displacement = position - member.home();
    const double deficit = deficit_at(clearance_deficits.home, i);
    vehicle.out.push_back(
        in_turn(costs.takeoff_cost(climb), leg(displacement, deficit, nullptr, nullptr)));
    vehicle.back.push_back(
        in_turn(leg(-displacement, deficit, nullptr, nullptr), costs.landing_cost(climb)));
    vehicle.capture_point.push_back(costs.capture_cost(capture_points[i]));
    for (std::uint32_t j = 0; j < capture_points.size(); ++j) {
      if (i == j) continue;
      const std::size_t k = i * capture_points.size() + j;
      vehicle.legs[k] =
          leg(capture_points[j].view.position - position, deficit_at(clearance_deficits.legs, k),
              &capture_points[i], &capture_points[j]);
    }
  }
  return vehicle;
}

}  // namespace skycap::flight
