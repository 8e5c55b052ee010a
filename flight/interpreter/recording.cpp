#include "flight/interpreter/recording.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "flight/export/export.h"
#include "flight/export/scanner_commands.h"
#include "geometry/angle.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double direction_tolerance_deg = 1.0;
constexpr double recording_tolerance = 2.0 * rounding_bound;
constexpr double cruise_speed_tolerance = 0.011;  ///< WPML stores two decimals [m/s].

bool is_at(const Vector3d& a, const Vector3d& b) { return (a - b).norm() <= recording_tolerance; }

bool is_turned(double angle_deg, double expected_deg) {
  return !(std::abs(std::remainder(angle_deg - expected_deg, 360.0)) <= direction_tolerance_deg);
}

/// Returns the legs between the calibrations, which fly back and forth between the end waypoint and
/// a point on the adjacent leg.
std::span<const ScannedLeg> without_calibration(std::span<const ScannedLeg> legs) {
  if (legs.empty()) return legs;
  const Vector3d begin = legs.front().from, end = legs.back().to;
  for (int turn = 0; turn < calibration_turns; ++turn) {
    if (legs.size() > 2 && is_at(legs[1].to, begin)) legs = legs.subspan(2);
  }
  for (int turn = 0; turn < calibration_turns; ++turn) {
    if (legs.size() > 2 && is_at(legs[legs.size() - 2].from, end)) {
      legs = legs.first(legs.size() - 2);
    }
  }
  return legs;
}

double heading_deg(const geometry::View& observation) {
  return compute_yaw(observation) / geometry::radians_per_degree;
}

/// Returns the view at a position, or null without a view.
const geometry::View* look_at(const std::vector<geometry::View>& observations,
                              const Vector3d& position) {
  const auto found = std::ranges::find_if(observations, [&](const geometry::View& observation) {
    return is_at(observation.position, position);
  });
  return found == observations.end() ? nullptr : &*found;
}

/// Returns the problems of the scanner directions on a leg that starts with this heading.
Problems check_looks(const ScannedLeg& leg, double yaw_from_deg, double yaw_deg, double pitch_deg,
                     const std::string& name) {
  Problems problems;
  const auto add_problem = [&](const std::string& what, double is_deg, double right_deg) {
    problems.push_back(what + " of " + fixed(is_deg, 1) + " degrees; the " + name + " requires " +
                       fixed(right_deg, 1) + " degrees");
  };
  if (is_turned(leg.pitch_deg, pitch_deg))
    add_problem("has a gimbal pitch", leg.pitch_deg, pitch_deg);
  if (is_turned(leg.yaw_from_deg, yaw_from_deg)) {
    add_problem("starts with a heading", leg.yaw_from_deg, yaw_from_deg);
  }
  if (is_turned(leg.yaw_deg, yaw_deg)) add_problem("ends with a heading", leg.yaw_deg, yaw_deg);
  return problems;
}

}  // namespace

Problems check_recording(std::span<const ScannedLeg> legs, const FlightFacts& facts) {
  Problems problems;
  const std::string name = facts.vehicle ? commanded_scanner(facts.vehicle->wpml.payload) : "";
  if (name.empty()) return problems;
  double yaw_deg = facts.views.empty() ? 0.0 : heading_deg(facts.views.front());
  for (const ScannedLeg& leg : without_calibration(legs)) {
    const std::string who = "the leg from " + leg.from_item + " to " + leg.to_item + " ";
    if (!leg.is_recorded) problems.push_back(who + "is not recorded by the " + name);
    if (!(std::abs(leg.speed - facts.cruise_speed) <= cruise_speed_tolerance)) {
      problems.push_back(who + "is flown at " + fixed(leg.speed, 2) +
                         " m/s; the mission's legs are flown at " + fixed(facts.cruise_speed, 2) +
                         " m/s");
    }
    if (facts.views.empty()) continue;
    // The vehicle turns on the last segment of a leg. Corners keep the previous heading.
    const geometry::View* observation = look_at(facts.views, leg.to);
    const double next_deg = observation == nullptr ? yaw_deg : heading_deg(*observation);
    const double pitch_deg = compute_pitch(facts.views.front()) / geometry::radians_per_degree;
    for (const std::string& problem : check_looks(leg, yaw_deg, next_deg, pitch_deg, name)) {
      problems.push_back(who + problem);
    }
    yaw_deg = next_deg;
  }
  return problems;
}

}  // namespace skycap::flight
