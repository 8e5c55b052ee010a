#include "flight/fly_test/return_flight.h"

#include <algorithm>
#include <cmath>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

// ArduCopter cuts the top corner within WP_RADIUS. PX4 ends its climb within NAV_MC_ALT_RAD and
// starts its descent within NAV_ACC_RAD.

/// Switching distances of DJI vehicles by their own estimate [m]. Within 20 or 50 m, depending on
/// the model, they fly home at their current altitude. Within 5 m they land on the spot.
constexpr double dji_least_level = 20.0, dji_most_level = 50.0, dji_landing = 5.0;

/// PX4 holds before a return (COM_FAIL_ACT_T), ArduCopter above home (RTL_LOIT_TIME) [s].
constexpr double px4_hold = 5.0, ardupilot_hold = 5.0;

/// Maximum distance from the pad centre at which a vehicle counts as above the pad [m].
constexpr double over_the_pad = 2.0;

double distance_over_ground(const Vector3d& a, const Vector3d& b) {
  return (a - b).head<2>().norm();
}

Vector3d at_height(const Vector3d& place, double z) { return {place.x(), place.y(), z}; }

Vector3d nearest_landing(const ReturnLaw& law, const Vector3d& place) {
  return *std::ranges::min_element(law.landings, {}, [&](const Vector3d& landing) {
    return distance_over_ground(landing, place);
  });
}

/// Adds the climb, the rounded corner and the level flight to the position above the landing point.
void climb_and_fly(const Vector3d& over, double cut, std::vector<Vector3d>& way) {
  const Vector3d place = way.back();
  const Vector3d level(over.x() - place.x(), over.y() - place.y(), 0.0);
  const double left = over.z() - place.z();
  const double below = std::min(cut, std::max(0.0, left));
  const double beside = std::min(cut, level.norm());
  way.push_back(at_height(place, over.z() - below));
  if (beside > 0.0) {
    way.push_back(at_height(place, over.z()) + level * (beside / level.norm()));
  }
  way.push_back(over);
}

}  // namespace

std::vector<Vector3d> return_way(const ReturnLaw& law, const Vector3d& place,
                                 geometry::RandomNumbers& random) {
  const Vector3d landing = nearest_landing(law, place);
  const double top = std::max(law.level, place.z());
  const double away = distance_over_ground(place, landing);
  std::vector<Vector3d> way{place};
  const Dialect dialect = law.dialects.front();
  if (dialect == Dialect::ardupilot) {
    climb_and_fly(at_height(landing, top), random.between(0.0, ardupilot_waypoint_radius), way);
  } else if (dialect == Dialect::px4) {
    const double end = std::max(place.z(), top - random.between(0.0, px4_altitude_radius));
    const double beside = random.between(0.0, std::min(px4_landing_radius, away));
    const Vector3d over = at_height(landing, top), start = at_height(place, top);
    way.push_back(at_height(place, end));
    way.push_back(away > 0.0 ? Vector3d(over + (start - over) * (beside / away)) : over);
  } else if (away > dji_landing) {
    const bool stays = away < random.between(dji_least_level, dji_most_level);
    if (!stays) way.push_back(at_height(place, top));
    way.push_back(at_height(landing, stays ? place.z() : top));
  }
  way.push_back(at_height(way.back(), landing.z()));
  return way;
}

FlightScript return_script(const ReturnLaw& law, const Motion& motion, const Vector3d& place,
                           geometry::RandomNumbers& random) {
  const Dialect dialect = law.dialects.front();
  const std::vector<Vector3d> way = return_way(law, place, random);
  const Vector3d over = way[way.size() - 2];
  const double foot = way.back().z(), seam = foot + law.landing_climb;
  FlightScript script;
  const auto append = [&](const ScriptedLeg& leg, bool is_over_pad) {
    script.push_back(leg);
    script.back().is_over_pad = is_over_pad;
  };
  // A recall during take-off starts in the column that the pilot must check.
  const bool begins_over_pad =
      place.z() < seam && distance_over_ground(place, way.back()) < over_the_pad;
  append({.from = place, .to = place, .wait = dialect == Dialect::px4 ? px4_hold : 1.0},
         begins_over_pad);
  for (std::size_t i = 1; i + 1 < way.size(); ++i) {
    const bool is_first_climb = begins_over_pad && i == 1 && way[i].z() > seam;
    const Vector3d middle = is_first_climb ? at_height(place, seam) : way[i - 1];
    if (is_first_climb) append(scripted_leg(motion, place, middle), true);
    append(scripted_leg(motion, middle, way[i]), false);
  }
  if (dialect == Dialect::ardupilot) script.back().wait += ardupilot_hold;
  const double vouched = std::min(over.z(), seam);
  append(landing_leg(motion, over, vouched, foot), false);
  append(landing_leg(motion, at_height(over, vouched), foot, foot), true);
  return script;
}

}  // namespace skycap::flight
