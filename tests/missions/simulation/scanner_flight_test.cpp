#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/pose/camera.h"
#include "missions/config/resolve.h"
#include "missions/session/survey_flight.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;

/// Returns a scan with returns from the ground, and from 50 m away up to this elevation.
geometry::Scan far_returns(const geometry::View& from, double max_elevation) {
  geometry::Scan scan{.world_from_sensor = geometry::camera_pose(from)};
  constexpr double step = 0.003, min_elevation = -0.8, widest = 1.2, farthest = 50.0;
  for (double up = min_elevation; up < max_elevation; up += step) {
    const double range = std::min(farthest, from.position.z() / std::max(-std::sin(up), 1e-9));
    for (double aside = -widest; aside < widest; aside += step) {
      const Vector3d direction(std::cos(up) * std::cos(aside), std::cos(up) * std::sin(aside),
                               std::sin(up));
      scan.points.emplace_back((from.position + range * direction).cast<float>());
    }
  }
  return scan;
}

// Autopilots climb before they return. A view below unobserved space is rejected, although the path
// to it is free.
TEST(ScannerFlight, ReachesOnlyViewsWithFreeReturnClimb) {
  const config::MissionSetup mission = config::parse_mission(
      "scene: {model: builtin:teapot, longest_side: 20}\n"
      "sensor: {lidar: ouster_os1_128}\n"
      "planner: {density: 100, resolution_radius: 0.5, view_distance: 20}\n"
      "evaluation: {coverage_distance: 0.1}\n"
      "flight: {vehicle: m350_rtk, cruise_speed: 4, unknown_box: {min: [-15, -15, 0], max: [15, "
      "15, 30]}}\n",
      "m.yaml");
  const geometry::View first = geometry::look_at({-20, 0, 10}, {0, 0, 10});
  const geometry::View inside = geometry::look_at({0, 0, 10}, {0, 10, 10});
  session::SurveyFlight flight(mission.flight(), first, 0);
  EXPECT_TRUE(flight.can_reach(first.position, geometry::look_at({-20, 15, 20}, {0, 0, 20})));
  EXPECT_FALSE(flight.find_path(first.position, inside.position));
  flight.add_scan(far_returns(first, 0.25));
  EXPECT_TRUE(flight.find_path(first.position, inside.position));
  EXPECT_FALSE(flight.may_be_at(inside.position));
  EXPECT_FALSE(flight.can_reach(first.position, inside));
  // All space above the path up to the near upper edge of the box, 76 degrees up. This autopilot
  // may also return without a climb, at any altitude that it has reached.
  flight.add_scan(far_returns(first, 1.4));
  EXPECT_TRUE(flight.may_be_at(inside.position));
  EXPECT_TRUE(flight.can_reach(first.position, inside));
}

}  // namespace
}  // namespace skycap::missions
