/// Time and energy of legs and of the stops between them.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "flight/motion/motion.h"
#include "flight/route/leg_planner.h"
#include "flight/route/route.h"
#include "flight/route/sortie_split.h"
#include "flight/rtl/return_paths.h"

namespace skycap::flight {

using LegCost = SplitProblem::Cost;

LegCost compute_cost(const Leg& leg);
/// Returns the cost of `first` followed by `second`.
LegCost in_turn(const LegCost& first, const LegCost& second);

/// Returns the maximum number of waypoints per sortie, from the vehicle's limit on mission items.
/// Waypoints that are passed without a stop need fewer items.
std::size_t max_capture_points(const Vehicle& vehicle, bool are_passed = false);

/// Returns the maximum number of waypoints per sortie, including the two above the pad and the
/// corners. Unlimited for vehicles whose limit is on mission items.
std::size_t max_sortie_waypoints(const Vehicle& vehicle);

/// Cost model of legs and stops. Keeps references to the constructor arguments.
class LegCosts {
 public:
  /// If `returns` is given, the emergency energy of a cost includes the most expensive return.
  /// `*returns` may be set later.
  explicit LegCosts(const Motion& motion, const std::optional<ReturnPaths>* returns = nullptr)
      : motion_(motion), returns_(returns) {}

  /// Returns the leg along `path` with a stop at each point. A null waypoint stands for the pad,
  /// where the camera needs no aim.
  Leg leg(VerifiedPath path, const CapturePoint* from, const CapturePoint* to) const;

  /// Returns the leg duration including the final yaw and gimbal rotation [s].
  double aimed_time(double leg, const CapturePoint* from, const CapturePoint* to) const;

  LegCost takeoff_cost(double climb) const;
  LegCost landing_cost(double climb) const;
  LegCost capture_cost(const CapturePoint& capture_point) const;

 private:
  double return_cost(const Eigen::Vector3d& position) const;

  const Motion& motion_;
  const std::optional<ReturnPaths>* returns_;
};

}  // namespace skycap::flight
