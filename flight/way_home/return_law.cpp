#include "flight/way_home/return_law.h"

#include <algorithm>
#include <limits>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Deviations of an autopilot from the common law [m].
struct Habits {
  double level_below = 0.0;  ///< Maximum distance of the level flight below the return altitude.
  /// Maximum horizontal distance of the descent from the landing point.
  double landing_radius = 0.0;
  double level_as_it_is = 0.0;  ///< Distance below which it may fly home level without a climb.
  double lands_at_once = 0.0;   ///< Distance below which it may land on the spot.
};

/// Tolerance for DJI's switching distances [m]. The vehicle measures them with an error and from
/// where it has come to rest.
constexpr double dji_tolerance = 3.0;

constexpr Habits habits_of(Dialect dialect) {
  switch (dialect) {
    case Dialect::ardupilot:
      return {.level_below = ardupilot_waypoint_radius};
    case Dialect::px4:
      return {.level_below = px4_altitude_radius, .landing_radius = px4_landing_radius};
    case Dialect::dji:
      break;
  }
  return {.level_as_it_is = 50.0 + dji_tolerance, .lands_at_once = dji_lands_at_once};
}

/// Returns the maximum deviations of the law's autopilots.
Habits habits_of(const ReturnLaw& law) {
  Habits all;
  for (const Dialect dialect : law.dialects) {
    const Habits one = habits_of(dialect);
    all.level_below = std::max(all.level_below, one.level_below);
    all.landing_radius = std::max(all.landing_radius, one.landing_radius);
    all.level_as_it_is = std::max(all.level_as_it_is, one.level_as_it_is);
    all.lands_at_once = std::max(all.lands_at_once, one.lands_at_once);
  }
  return all;
}

double distance_over_ground(const Vector3d& a, const Vector3d& b) {
  return (a - b).head<2>().norm();
}

Vector3d at_height(const Vector3d& place, double z) { return {place.x(), place.y(), z}; }

/// Maximum error of the autopilot's own distance estimate when it selects the nearest landing point
/// [m].
constexpr double choice_tolerance = 10.0;

/// Returns the landing points that are nearest, or may appear nearest, from a position within
/// `reach`.
std::vector<Vector3d> landings_near(const ReturnLaw& law, const Vector3d& place, double reach) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vector3d& landing : law.landings) {
    nearest = std::min(nearest, distance_over_ground(place, landing));
  }
  std::vector<Vector3d> chosen;
  for (const Vector3d& landing : law.landings) {
    const double surplus = distance_over_ground(place, landing) - nearest;
    if (surplus <= 2.0 * reach + choice_tolerance) chosen.push_back(landing);
  }
  return chosen;
}

}  // namespace

const char* name_of(ReturnPart part) {
  switch (part) {
    case ReturnPart::climb:
      return "the climb";
    case ReturnPart::level:
      return "the level flight";
    case ReturnPart::level_as_it_is:
      return "the level flight without a climb (as within 50 m of the take-off point)";
    case ReturnPart::descent:
      return "the descent";
    case ReturnPart::landing:
      break;
  }
  return "the landing on the spot";
}

std::vector<ReturnPiece> return_pieces(const ReturnLaw& law, const Vector3d& place, double reach) {
  const Habits habits = habits_of(law);
  const double top = std::max(law.level, place.z());
  std::vector<ReturnPiece> pieces{{{place, at_height(place, top)}, 0.0, ReturnPart::climb}};
  // A height interval is represented by its middle line with half the interval as spread.
  const double spread = 0.5 * habits.level_below, level = top - spread;
  const double around = reach + law.reserve;
  for (const Vector3d& landing : landings_near(law, place, around)) {
    pieces.push_back(
        {{at_height(place, level), at_height(landing, level)}, spread, ReturnPart::level});
    const double nearest = distance_over_ground(place, landing) - around;
    if (nearest < habits.level_as_it_is) {
      pieces.push_back({{place, at_height(landing, place.z())}, 0.0, ReturnPart::level_as_it_is});
    }
    const double low = landing.z() + law.landing_climb;
    if (nearest < habits.lands_at_once && place.z() + around > low) {
      pieces.push_back(
          {{place, at_height(place, std::min(low, place.z()))}, 0.0, ReturnPart::landing});
    }
  }
  return pieces;
}

std::vector<ReturnPiece> landing_columns(const ReturnLaw& law, double top) {
  const double spread = habits_of(law).landing_radius;
  std::vector<ReturnPiece> columns;
  for (const Vector3d& landing : law.landings) {
    columns.push_back(
        {{at_height(landing, top), at_height(landing, landing.z() + law.landing_climb)},
         spread,
         ReturnPart::descent});
  }
  return columns;
}

}  // namespace skycap::flight
