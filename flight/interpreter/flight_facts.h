/// What a mission says that its route files must agree with.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/export/flight_plan.h"
#include "flight/motion/vehicle.h"
#include "flight/space/obstacles.h"
#include "geometry/place/pose.h"

namespace skycap::flight {

struct FlightFacts {
  Site site;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  bool is_pad_known = true;        ///< else only its height is, and it is where the file takes off
  std::optional<Vehicle> vehicle;  ///< without one its limits are not checked
  double takeoff_climb = 5.0;      ///< vouched for above the pad, and above rally points [m]
  std::vector<Eigen::Vector3d> rally;  ///< where it may land beside the pad when called home
  double cruise_speed = 4.0;           ///< the fastest that the tracking error is meant for [m/s]
  double hold = 0.0;                   ///< at rest before a photograph [s]
  std::vector<Prism> no_fly;
  std::optional<Prism> fence;
  std::vector<geometry::View> views;  ///< to be photographed; none: not known, and not checked
};

/// The facts of the flight that a file is written for.
FlightFacts facts_of(const FlightPlan& plan);

/// Farthest that a place that a file states as the pad may be from it, over ground and in height
/// [m]: receivers without corrections differ by as much.
inline constexpr double pad_tolerance = 2.0, pad_height_tolerance = 1.0;

}  // namespace skycap::flight
