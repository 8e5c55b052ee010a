#include "flight/interpreter/photographs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "flight/export/export.h"
#include "geometry/angle.h"

namespace skycap::flight {
namespace {

constexpr double degree = geometry::radians_per_degree;

/// Maximum angle between a photo and its view: Litchi stores whole degrees of pitch.
constexpr double direction_tolerance = 1.0 * degree;

/// Maximum distance between a photo and its view [m]: rounding, and ArduPilot's centimetres of
/// height.
constexpr double position_tolerance = 2.0 * rounding_bound;

/// Rounding of times in the formats [s].
constexpr double hold_tolerance = 0.005;

Eigen::Vector3d compute_direction(const InterpretedStop& stop) {
  const double yaw = stop.yaw_deg * degree, pitch = stop.pitch_deg * degree;
  return {std::cos(pitch) * std::sin(yaw), std::cos(pitch) * std::cos(yaw), std::sin(pitch)};
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Returns the mismatch between a photo and the views, or an empty string.
std::string compare(const InterpretedStop& stop, const std::vector<geometry::View>& views) {
  double nearest = position_tolerance, turned = std::numbers::pi;
  bool is_matched = false;
  for (const geometry::View& view : views) {
    if ((view.position - stop.position).norm() > nearest) continue;
    is_matched = true;
    turned = std::min(turned, angle_between(compute_direction(stop), view.direction));
  }
  if (!is_matched) return "captures an image at a position that is not a view of the mission";
  if (std::isnan(stop.yaw_deg)) return "captures an image without a heading";
  if (std::isnan(stop.pitch_deg)) return "captures an image without a gimbal pitch";
  if (turned <= direction_tolerance) return "";
  return "captures an image " + fixed(turned / degree, 1) + " degrees away from its view";
}

}  // namespace

Problems check_photographs(const std::vector<InterpretedStop>& stops, const FlightFacts& facts) {
  Problems problems;
  for (const InterpretedStop& stop : stops) {
    const auto add_problem = [&](const std::string& what) {
      problems.push_back(stop.item + " " + what);
    };
    if (stop.hold < facts.hold - hold_tolerance) {
      add_problem("holds " + fixed(stop.hold, 2) + " s before its image; the mission requires " +
                  fixed(facts.hold, 2) + " s");
    }
    if (facts.vehicle) {
      const double pitch = stop.pitch_deg * degree;
      if (pitch < facts.vehicle->gimbal_min - direction_tolerance ||
          pitch > facts.vehicle->gimbal_max + direction_tolerance) {
        add_problem("pitches the gimbal to " + fixed(stop.pitch_deg, 1) + " degrees, which \"" +
                    facts.vehicle->name + "\" cannot");
      }
    }
    if (facts.views.empty()) continue;
    if (const std::string what = compare(stop, facts.views); !what.empty()) add_problem(what);
  }
  return problems;
}

}  // namespace skycap::flight
