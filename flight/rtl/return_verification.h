/// Proof that every return from every point of a leg is free, without sampling.
///
/// The distance between a point and an obstacle changes by no more than the point moves. A return
/// changes by no more than its start position (return_law.h). If all returns from a position are
/// free at the clearance plus e, those from all positions within e are free at the clearance. The
/// leg is covered by such balls and is subdivided where they are too small.
#pragma once

#include <cstddef>
#include <string>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/rtl/rtl_profile.h"

namespace skycap::flight {

/// Result of the proof: the return with the minimum clearance, or the one that failed.
struct ReturnVerification {
  bool is_verified = false;
  /// Verified lower bound of all returns [m]. At most return_surplus above the required clearance.
  double clearance = 0.0;
  /// Start of the return with the minimum clearance.
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  ReturnSegment segment;  ///< Closest piece of that return.
  Closest closest{};
  std::size_t queries = 0;  ///< Number of distance queries, as a measure of effort.
};

/// Minimum ball size of the proof [m]. If all returns of a leg exceed the clearance by less, the
/// leg counts as not verified.
inline constexpr double return_slack = 0.05;

/// Returns the clearance at which the returns of a route are verified whose legs are verified at
/// `clearance` [m].
inline double return_clearance(double clearance) {
  return clearance > return_slack ? clearance - return_slack : 0.0;
}

/// Maximum surplus of reported return clearances above the required one [m].
inline constexpr double return_surplus = 1.0;

/// Verifies the returns from every point of the leg, except the columns above the landing points.
/// The balls have a radius of at least `slack` [m].
ReturnVerification verify_returns(const FreeSpace& space, const Segment& leg,
                                  const RtlProfile& rtl_profile, double clearance,
                                  double slack = return_slack);

/// Verifies the columns above the landing points, from `top` (z) down to the height below which the
/// pilot must check them.
ReturnVerification verify_landings(const FreeSpace& space, const RtlProfile& rtl_profile,
                                   double top, double clearance);

/// Returns the obstacle and its position: "the climb from (x, y, z) comes within 0.8 m of the
/// ground".
std::string describe(const ReturnVerification& failed, const FreeSpace& space);

}  // namespace skycap::flight
