#include "missions/session/initial_pattern_flight.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/config/resolve.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::session {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using geometry::View;

config::MissionSetup make_mission(const std::string& box, const std::string& more = "") {
  return config::parse_mission(
      "scene: {model: builtin:teapot, longest_side: 20}\n"
      "sensor: {lidar: ouster_os1_128}\n"
      "planner: {density: 100, resolution_radius: 0.5, view_distance: 20}\n"
      "evaluation: {coverage_distance: 0.1}\n"
      "flight: {vehicle: m350_rtk, unknown_box: " +
          box + more + "}\n",
      "m.yaml");
}

/// Returns the initial pattern for the first seed.
std::vector<View> planned_initial_views(const config::MissionSetup& mission) {
  return initial_pattern_views(mission.survey().start, 1);
}

constexpr const char* house = "{min: [-10, -20, 0], max: [10, 20, 20]}";
constexpr const char* tower = "{min: [-10, -20, 0], max: [10, 20, 40]}";
constexpr const char* block = "{min: [-100, -60, 0], max: [100, 60, 30]}";

/// Returns the minimum distance between the path through the views and the box, by sampling.
double nearest(const std::vector<View>& views, const AlignedBox3d& box) {
  double min = 1e9;
  for (std::size_t i = 1; i < views.size(); ++i) {
    for (int hundredth = 0; hundredth <= 100; ++hundredth) {
      const double share = 0.01 * hundredth;
      const Vector3d at =
          views[i - 1].position + share * (views[i].position - views[i - 1].position);
      min = std::min(min, box.exteriorDistance(at));
    }
  }
  return min;
}

/// Returns the total angle of the path around the z axis.
double turned(const std::vector<View>& views) {
  double turned = 0.0;
  for (std::size_t i = 1; i < views.size(); ++i) {
    const Vector3d &a = views[i - 1].position, &b = views[i].position;
    turned += std::atan2(a.x() * b.y() - a.y() * b.x(), a.head<2>().dot(b.head<2>()));
  }
  return turned;
}

TEST(InitialPatternFlight, OrbitsOnceOutsideBox) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const config::MissionSetup mission = make_mission(house);
    EXPECT_EQ(mission.survey().start.initial_pattern, InitialPattern::orbit);
    const std::vector<View> views = initial_pattern_views(mission.survey().start, seed);
    ASSERT_EQ(views.size(), 5U);
    EXPECT_GT(nearest(views, mission.flight().unknown_box), mission.flight().clearance + 0.5);
    EXPECT_NEAR(turned(views), 2.0 * M_PI, 1e-9);
    for (const View& view : views) {
      EXPECT_LT(view.direction.dot(view.position), 0.0);  // looks at the centre
    }
  }
}

TEST(InitialPatternFlight, OrbitsTallBoxSeveralTimes) {
  const config::MissionSetup mission = make_mission(tower);  // 40 m high, observed from 20 m
  const std::vector<View> views = planned_initial_views(mission);
  EXPECT_NEAR(turned(views), 4.0 * M_PI, 1e-9);
  EXPECT_GT(nearest(views, mission.flight().unknown_box), mission.flight().clearance + 0.5);
  for (std::size_t i = 1; i < views.size(); ++i) {
    const double climbed = views[i].position.z() - views[i - 1].position.z();
    EXPECT_GE(climbed, 0.0);
    EXPECT_LT(climbed, 0.75 * 40.0);
  }
  EXPECT_LT(views.front().position.z(), 0.3 * 40.0);
  EXPECT_GT(views.back().position.z(), 0.85 * 40.0);
  // From farther away, one view sees more. Without a limit, the pattern would be the only plan.
  EXPECT_EQ(planned_initial_views(make_mission("{min: [-30, -30, 0], max: [30, 30, 33]}")).size(),
            5U);
  EXPECT_LE(planned_initial_views(make_mission("{min: [-1, -1, 0], max: [1, 1, 9000]}")).size(),
            129U);
}

TEST(InitialPatternFlight, FliesStripsOverFlatBoxWithLimitedSpacing) {
  const config::MissionSetup mission = make_mission(block);
  EXPECT_EQ(mission.survey().start.initial_pattern, InitialPattern::strips);
  const std::vector<View> views = planned_initial_views(mission);
  ASSERT_EQ(views.size() % 2, 0U);
  EXPECT_GT(nearest(views, mission.flight().unknown_box), mission.flight().clearance + 0.5);
  EXPECT_LE(120.0 / (0.5 * static_cast<double>(views.size())), views[0].position.z());
  for (std::size_t i = 0; i < views.size(); i += 2) {
    EXPECT_NEAR((views[i + 1].position - views[i].position).norm(), 200.0, 1e-9);  // along the row
  }
}

TEST(InitialPatternFlight, IsOmittedWhenDisabled) {
  EXPECT_TRUE(planned_initial_views(make_mission(tower, ", initial_pattern: none")).empty());
  EXPECT_EQ(planned_initial_views(make_mission(tower, ", initial_pattern: strips")).size() % 2, 0U);
}

// The speed allowed by a scanner's density increases with its rotation rate, up to half the maximum
// speed of the vehicle.
TEST(InitialPatternFlight, FliesSlowerForHigherDensity) {
  const config::MissionSetup mission = make_mission(tower);
  const double coarse = mission.flight().cruise_speed;
  EXPECT_DOUBLE_EQ(coarse, 7.5);  // half of the m350_rtk's 15 m/s
  const auto speed_at = [&](double spacing) {
    return sim::scanning_speed(mission.sensor(), mission.survey().planner.view_distance, spacing,
                               mission.flight().required_vehicle().max_speed);
  };
  const double fine = speed_at(0.025);
  EXPECT_LT(fine, coarse);
  // The same number of rays on half the area.
  EXPECT_NEAR(speed_at(0.025 * std::sqrt(0.5)), 0.5 * fine, 1e-9);
}

}  // namespace
}  // namespace skycap::missions::session
