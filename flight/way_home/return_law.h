/// The way home that an autopilot flies by itself when its pilot, its link or its battery asks for
/// it, as straight pieces.
///
/// All three go up from where they are to a height of return, level and straight to a landing
/// place, and down. They differ in what they do beside that:
/// - ArduCopter (mode_rtl.cpp, with RTL_CONE_SLOPE 0 and RTL_CLIMB_MIN 0) takes the corner between
///   climb and level flight as a fast waypoint and cuts it within WP_RADIUS, 2 m. Of several
///   landing places it takes the one nearest to where the return begins.
/// - PX4 (rtl.cpp, rtl_direct.cpp, with RTL_CONE_ANG 0) flies level from NAV_MC_ALT_RAD, 0.8 m,
///   below the height of return, and may sink within NAV_ACC_RAD, set to 1 m, of the landing place.
/// - DJI (the manuals' chapters "RTH") climbs only when it is farther than 50 m from home, older
///   models 20 m; nearer it flies home level at the height it has, and within 5 m it lands where it
///   is. Both ways of flying are asked for between 5 and 50 m.
///
/// docs/reference/route-formats.md, "Return: parameters per autopilot", says which settings that
/// takes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/vehicle.h"
#include "flight/space/segment_distance.h"

namespace skycap::flight {

/// Settings that the law counts on [m]; parameter files make them, and checks ask for no more.
inline constexpr double ardupilot_waypoint_radius = 2.0;  ///< WP_RADIUS_M
inline constexpr double px4_altitude_radius = 0.8;        ///< NAV_MC_ALT_RAD
inline constexpr double px4_landing_radius = 1.0;         ///< NAV_ACC_RAD

/// How far from home DJI's vehicles may land at once: 5 m, by their own measure [m].
inline constexpr double dji_lands_at_once = 8.0;

/// Where and how high vehicles return. Heights are z in the local frame.
struct ReturnLaw {
  std::vector<Dialect> dialects;          ///< the autopilots whose ways home are all meant
  double level = 0.0;                     ///< z of the level flight, unless the vehicle is above it
  std::vector<Eigen::Vector3d> landings;  ///< the pad first, then rally points; on the ground
  /// Above each landing: from there down the pilot vouches for the column.
  double landing_climb = 5.0;
  /// Distances and heights at which vehicles fly otherwise are taken this much wider: for planning,
  /// so that no leg ends where a proof hangs on how it divides that leg [m].
  double reserve = 0.0;
};

enum class ReturnPart { climb, level, level_as_it_is, descent, landing };

/// Level or upright; the vehicle may be up to `spread` beside it.
struct ReturnPiece {
  Segment line;
  double spread = 0.0;
  ReturnPart part = ReturnPart::climb;
};

/// "the climb", "the level flight", ... for messages.
const char* name_of(ReturnPart part);

/// The pieces of all ways home from `place`, but the column over the landing place. With `reach`,
/// those that any place within `reach` of it may have: each of its pieces then has a counterpart
/// here, none of whose points is farther away than the two places are from each other (the law is
/// 1-Lipschitz). What is free around these pieces by `reach` more is therefore free around all of
/// those, which is what prove_returns() rests on.
std::vector<ReturnPiece> return_pieces(const ReturnLaw& law, const Eigen::Vector3d& place,
                                       double reach = 0.0);

/// The column over each landing place, from `top` down to landing_climb above it.
std::vector<ReturnPiece> landing_columns(const ReturnLaw& law, double top);

}  // namespace skycap::flight
