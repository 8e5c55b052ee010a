#include "flight/rtl/rtl_profile.h"

#include <algorithm>
#include <limits>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Deviations of an autopilot from the common law [m].
struct AutopilotTraits {
  double level_below = 0.0;  ///< Maximum distance of the level flight below the return altitude.
  /// Maximum horizontal distance of the descent from the landing point.
  double landing_radius = 0.0;
  double level_as_it_is = 0.0;  ///< Distance below which it may fly home level without a climb.
  double lands_at_once = 0.0;   ///< Distance below which it may land on the spot.
};

/// Minimum tolerance for DJI's switching distances [m]: the braking distance, plus the error with
/// which vehicles measure their position.
constexpr double dji_tolerance = 3.0;
constexpr double dji_position_error = 0.3;

constexpr AutopilotTraits autopilot_traits(AutopilotType autopilot) {
  switch (autopilot) {
    case AutopilotType::ardupilot:
      return {.level_below = ardupilot_corner};
    case AutopilotType::px4:
      return {.level_below = px4_altitude_radius, .landing_radius = px4_landing_radius};
    case AutopilotType::dji:
      break;
  }
  return {.level_as_it_is = 50.0 + dji_tolerance, .lands_at_once = dji_lands_at_once};
}

/// Returns the distance by which braking extends DJI's switching distances beyond dji_tolerance
/// [m].
double dji_extension(double braking) {
  return std::max(0.0, braking + dji_position_error - dji_tolerance);
}

/// Returns the maximum deviations of the law's autopilots.
AutopilotTraits autopilot_traits(const RtlProfile& rtl_profile) {
  AutopilotTraits all;
  for (const AutopilotType autopilot : rtl_profile.autopilots) {
    const AutopilotTraits one = autopilot_traits(autopilot);
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

Vector3d at_height(const Vector3d& position, double z) { return {position.x(), position.y(), z}; }

/// Minimum tolerance when the autopilot selects the nearest landing point [m]. It covers the error
/// of the autopilot's own distance estimate.
constexpr double choice_tolerance = 10.0;

/// Returns the landing points that are nearest, or may appear nearest, from a position within
/// `reach`.
std::vector<Vector3d> landings_near(const RtlProfile& rtl_profile, const Vector3d& position,
                                    double reach) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vector3d& landing : rtl_profile.landings) {
    nearest = std::min(nearest, distance_over_ground(position, landing));
  }
  std::vector<Vector3d> chosen;
  for (const Vector3d& landing : rtl_profile.landings) {
    const double surplus = distance_over_ground(position, landing) - nearest;
    const double tolerance = std::max(choice_tolerance, 2.0 * rtl_profile.braking);
    if (surplus <= 2.0 * reach + tolerance) chosen.push_back(landing);
  }
  return chosen;
}

}  // namespace

double dji_climb_distance(double braking) {
  return autopilot_traits(AutopilotType::dji).level_as_it_is + dji_extension(braking);
}

const char* to_string(ReturnPart part) {
  switch (part) {
    case ReturnPart::climb:
      return "the climb";
    case ReturnPart::level:
      return "the level flight";
    case ReturnPart::level_as_it_is:
      return "the level flight without a climb (possible within 50 m of the take-off point)";
    case ReturnPart::descent:
      return "the descent";
    case ReturnPart::landing:
      break;
  }
  return "the landing in place";
}

std::vector<ReturnSegment> return_segments(const RtlProfile& rtl_profile, const Vector3d& position,
                                           double reach) {
  const AutopilotTraits traits = autopilot_traits(rtl_profile);
  const double top = std::max(rtl_profile.level, position.z());
  std::vector<ReturnSegment> segments{
      {{position, at_height(position, top)}, 0.0, ReturnPart::climb}};
  // A height interval is represented by its middle line with half the interval as spread.
  const double spread = 0.5 * traits.level_below, level = top - spread;
  const double around = reach + rtl_profile.reserve;
  for (const Vector3d& landing : landings_near(rtl_profile, position, around)) {
    segments.push_back(
        {{at_height(position, level), at_height(landing, level)}, spread, ReturnPart::level});
    const double nearest =
        distance_over_ground(position, landing) - around - dji_extension(rtl_profile.braking);
    if (nearest < traits.level_as_it_is) {
      segments.push_back(
          {{position, at_height(landing, position.z())}, 0.0, ReturnPart::level_as_it_is});
    }
    const double low = landing.z() + rtl_profile.landing_climb;
    if (nearest < traits.lands_at_once && position.z() + around > low) {
      segments.push_back(
          {{position, at_height(position, std::min(low, position.z()))}, 0.0, ReturnPart::landing});
    }
  }
  return segments;
}

std::vector<ReturnSegment> landing_columns(const RtlProfile& rtl_profile, double top) {
  const double spread = autopilot_traits(rtl_profile).landing_radius;
  std::vector<ReturnSegment> columns;
  for (const Vector3d& landing : rtl_profile.landings) {
    columns.push_back(
        {{at_height(landing, top), at_height(landing, landing.z() + rtl_profile.landing_climb)},
         spread,
         ReturnPart::descent});
  }
  return columns;
}

}  // namespace skycap::flight
