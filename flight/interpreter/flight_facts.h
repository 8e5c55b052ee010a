/// Mission properties that route files must agree with.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/obstacles.h"
#include "flight/export/flight_plan.h"
#include "flight/motion/photo_speed.h"
#include "flight/motion/vehicle.h"
#include "geometry/pose/pose.h"

namespace skycap::flight {

struct FlightFacts {
  Site site;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  /// If false, only the pad height is known, and the pad is at the take-off position of the file.
  bool is_pad_known = true;
  std::optional<Vehicle> vehicle;  ///< Without a vehicle, its limits are not checked.
  /// Height above the pad and rally points that the pilot must check [m].
  double takeoff_climb = 5.0;
  std::vector<Eigen::Vector3d> rally;  ///< Alternative landing points for returns.
  double cruise_speed = 4.0;  ///< Maximum speed for which the tracking error is valid [m/s].
  double hold = 0.0;          ///< Rest time before a photo [s].
  std::vector<Prism> no_fly;
  std::optional<Prism> fence;
  std::vector<geometry::View> views;    ///< Required views. Empty: unknown and not checked.
  std::optional<PhotoShutter> photo{};  ///< of a mission with a photo camera
};

/// Returns the facts of the flight that a file is written for.
FlightFacts make_flight_facts(const FlightPlan& plan);

/// Maximum distance between the file's pad and the mission's, horizontal and vertical [m].
/// Receivers without corrections differ by as much.
inline constexpr double pad_tolerance = 2.0, pad_height_tolerance = 1.0;

}  // namespace skycap::flight
