/// Straight-line model of the return that an autopilot flies automatically on pilot command, link
/// loss or low battery.
///
/// All three autopilots climb to a return altitude, fly level and straight to a landing point, and
/// descend. They differ in the following details.
///
/// ArduCopter (mode_rtl.cpp, with RTL_CONE_SLOPE 0 and RTL_CLIMB_MIN 0) treats the corner between
/// climb and level flight as a fast waypoint. Versions 4.1 to 4.5 keep only the middle of this
/// corner within WP_RADIUS (SCurve.cpp). With WP_RADIUS 0.5 m, every version stays on the climb or
/// within 2 m below the return altitude. Among several landing points it selects the one closest to
/// the start of the return.
///
/// PX4 (rtl.cpp, rtl_direct.cpp, with RTL_CONE_ANG 0) flies level up to NAV_MC_ALT_RAD, 0.8 m by
/// default, below the return altitude. It may descend within NAV_ACC_RAD, set to 1 m, of the
/// landing point.
///
/// DJI (manuals, chapters "RTH") climbs only if farther than 50 m from home (older models 20 m).
/// Closer, it flies home level at its current altitude, and within 5 m it lands on the spot.
/// Between 5 and 50 m both variants must be free.
///
/// For versions and sources see docs/reference/autopilots.md, for the required settings
/// docs/reference/route-formats.md, "Return: parameters per
/// autopilot".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/segment_distance.h"
#include "flight/motion/vehicle.h"

namespace skycap::flight {

/// Settings that the law assumes [m]. Parameter files set them, and checks require them.
inline constexpr double ardupilot_waypoint_radius = 0.5;  ///< WP_RADIUS_M.
inline constexpr double px4_altitude_radius = 0.8;        ///< NAV_MC_ALT_RAD.
inline constexpr double px4_landing_radius = 1.0;         ///< NAV_ACC_RAD.

/// Maximum distance of ArduCopter's level flight below the return altitude near the climb [m].
inline constexpr double ardupilot_corner = 2.0;

/// Maximum distance from home at which DJI vehicles may land on the spot: 5 m by their own
/// estimate, plus tolerance [m].
inline constexpr double dji_lands_at_once = 8.0;

/// Returns the distance from home beyond which DJI vehicles climb before they return [m]. `braking`
/// is RtlProfile::braking.
double dji_climb_distance(double braking);

/// Landing points and altitude of returns. Heights are z in the local frame.
struct RtlProfile {
  std::vector<AutopilotType> autopilots;  ///< Autopilots whose variants are all covered.
  double level = 0.0;  ///< Height z of the level flight, unless the vehicle is higher [m].
  /// Landing points on the ground: the pad, then rally points.
  std::vector<Eigen::Vector3d> landings;
  /// Height above each landing point below which the pilot must check the column [m].
  double landing_climb = 5.0;
  /// Tolerance added to the distances and heights at which vehicles change their behaviour [m].
  /// Used in planning, so that no leg ends exactly where the proof becomes sensitive to its
  /// subdivision.
  double reserve = 0.0;
  /// Maximum distance that the vehicle brakes between the autopilot's decisions, for example on the
  /// landing point, and the start of the return [m].
  double braking = 0.0;
};

enum class ReturnPart { climb, level, level_as_it_is, descent, landing };

/// Level or vertical piece. The vehicle may be up to `spread` beside it [m].
struct ReturnSegment {
  Segment line;
  double spread = 0.0;
  ReturnPart part = ReturnPart::climb;
};

/// Returns the name of a part for messages: "the climb", "the level flight", ...
const char* to_string(ReturnPart part);

/// Returns the pieces of all returns from `position`, except the columns above the landing points.
/// With `reach` [m], the pieces cover the returns from all positions within `reach`. Every piece of
/// such a return has a counterpart here, at a distance no greater than that of the two positions
/// (the law is 1-Lipschitz). Free space around these pieces, extended by `reach`, therefore implies
/// free space around all those returns. verify_returns() relies on this property.
std::vector<ReturnSegment> return_segments(const RtlProfile& rtl_profile,
                                           const Eigen::Vector3d& position, double reach = 0.0);

/// Returns the column above each landing point, from `top` (z) down to landing_climb above it.
std::vector<ReturnSegment> landing_columns(const RtlProfile& rtl_profile, double top);

}  // namespace skycap::flight
