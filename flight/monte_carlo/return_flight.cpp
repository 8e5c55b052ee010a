#include "flight/monte_carlo/return_flight.h"

#include <algorithm>
#include <cmath>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

// ArduCopter cuts the top corner within ardupilot_corner. PX4 ends its climb within NAV_MC_ALT_RAD
// and starts its descent within NAV_ACC_RAD.

/// Switching distances of DJI vehicles by their own estimate [m]. Within 20 or 50 m, depending on
/// the model, they fly home at their current altitude. Within 5 m they land on the spot.
constexpr double dji_min_level = 20.0, dji_max_level = 50.0, dji_landing = 5.0;

/// PX4 holds before a return (COM_FAIL_ACT_T), ArduCopter above home (RTL_LOIT_TIME) [s].
constexpr double px4_hold = 5.0, ardupilot_hold = 5.0;

/// Maximum distance from the pad centre at which a vehicle counts as above the pad [m].
constexpr double over_the_pad = 2.0;

double distance_over_ground(const Vector3d& a, const Vector3d& b) {
  return (a - b).head<2>().norm();
}

Vector3d at_height(const Vector3d& position, double z) { return {position.x(), position.y(), z}; }

Vector3d nearest_landing(const RtlProfile& rtl_profile, const Vector3d& position) {
  return *std::ranges::min_element(rtl_profile.landings, {}, [&](const Vector3d& landing) {
    return distance_over_ground(landing, position);
  });
}

/// Adds the climb, the rounded corner and the level flight to the position above the landing point.
void climb_and_fly(const Vector3d& over, double cut, std::vector<Vector3d>& path) {
  const Vector3d position = path.back();
  const Vector3d level(over.x() - position.x(), over.y() - position.y(), 0.0);
  const double left = over.z() - position.z();
  const double below = std::min(cut, std::max(0.0, left));
  const double lateral = std::min(cut, level.norm());
  path.push_back(at_height(position, over.z() - below));
  if (lateral > 0.0) {
    path.push_back(at_height(position, over.z()) + level * (lateral / level.norm()));
  }
  path.push_back(over);
}

}  // namespace

std::vector<Vector3d> return_path(const RtlProfile& rtl_profile, const Vector3d& position,
                                  geometry::RandomNumbers& random) {
  const Vector3d landing = nearest_landing(rtl_profile, position);
  const double top = std::max(rtl_profile.level, position.z());
  const double away = distance_over_ground(position, landing);
  std::vector<Vector3d> path{position};
  const AutopilotType autopilot = rtl_profile.autopilots.front();
  if (autopilot == AutopilotType::ardupilot) {
    climb_and_fly(at_height(landing, top), random.between(0.0, ardupilot_corner), path);
  } else if (autopilot == AutopilotType::px4) {
    const double end = std::max(position.z(), top - random.between(0.0, px4_altitude_radius));
    const double lateral = random.between(0.0, std::min(px4_landing_radius, away));
    const Vector3d over = at_height(landing, top), start = at_height(position, top);
    path.push_back(at_height(position, end));
    path.push_back(away > 0.0 ? Vector3d(over + (start - over) * (lateral / away)) : over);
  } else if (away > dji_landing) {
    const bool stays = away < random.between(dji_min_level, dji_max_level);
    if (!stays) path.push_back(at_height(position, top));
    path.push_back(at_height(landing, stays ? position.z() : top));
  }
  path.push_back(at_height(path.back(), landing.z()));
  return path;
}

FlightScript return_script(const RtlProfile& rtl_profile, const Motion& motion,
                           const Vector3d& position, geometry::RandomNumbers& random) {
  const AutopilotType autopilot = rtl_profile.autopilots.front();
  const std::vector<Vector3d> path = return_path(rtl_profile, position, random);
  const Vector3d over = path[path.size() - 2];
  const double foot = path.back().z(), seam = foot + rtl_profile.landing_climb;
  FlightScript script;
  const auto append = [&](const ScriptedLeg& leg, bool is_over_pad) {
    script.push_back(leg);
    script.back().is_over_pad = is_over_pad;
  };
  // A recall during take-off starts in the column that the pilot must check.
  const bool begins_over_pad =
      position.z() < seam && distance_over_ground(position, path.back()) < over_the_pad;
  append(
      {.from = position, .to = position, .wait = autopilot == AutopilotType::px4 ? px4_hold : 1.0},
      begins_over_pad);
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const bool is_first_climb = begins_over_pad && i == 1 && path[i].z() > seam;
    const Vector3d middle = is_first_climb ? at_height(position, seam) : path[i - 1];
    if (is_first_climb) append(scripted_leg(motion, position, middle), true);
    append(scripted_leg(motion, middle, path[i]), false);
  }
  if (autopilot == AutopilotType::ardupilot) script.back().wait += ardupilot_hold;
  const double checked_top = std::min(over.z(), seam);
  if (over.z() > checked_top) append(landing_leg(motion, over, checked_top, foot), false);
  append(landing_leg(motion, at_height(over, checked_top), foot, foot), true);
  return script;
}

}  // namespace skycap::flight
