#include "missions/config/opening_flight.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/config/mission_flight.h"
#include "missions/config/resolved_mission.h"

namespace skycap::missions::config {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using geometry::View;

config::Mission mission_of(const std::string& box, const std::string& more = "") {
  return parse_mission(
      "scene: {model: builtin:teapot, longest_side: 20}\n"
      "sensor: {lidar: ouster_os1_128}\n"
      "planner: {density: 100, resolution_radius: 0.5, view_distance: 20}\n"
      "evaluation: {registration_distance: 0.1}\n"
      "flight: {vehicle: m350_rtk, unknown_box: " +
          box + more + "}\n",
      "m.yaml");
}

constexpr const char* house = "{min: [-10, -20, 0], max: [10, 20, 20]}";
constexpr const char* tower = "{min: [-10, -20, 0], max: [10, 20, 40]}";
constexpr const char* block = "{min: [-100, -60, 0], max: [100, 60, 30]}";

/// The least distance of the way through the views from the box, sampled.
double nearest(const std::vector<View>& views, const AlignedBox3d& box) {
  double least = 1e9;
  for (std::size_t i = 1; i < views.size(); ++i) {
    for (int hundredth = 0; hundredth <= 100; ++hundredth) {
      const double share = 0.01 * hundredth;
      const Vector3d at =
          views[i - 1].position + share * (views[i].position - views[i - 1].position);
      least = std::min(least, box.exteriorDistance(at));
    }
  }
  return least;
}

/// The angle by which the way turns about the z axis.
double turned(const std::vector<View>& views) {
  double turned = 0.0;
  for (std::size_t i = 1; i < views.size(); ++i) {
    const Vector3d &a = views[i - 1].position, &b = views[i].position;
    turned += std::atan2(a.x() * b.y() - a.y() * b.x(), a.head<2>().dot(b.head<2>()));
  }
  return turned;
}

TEST(OpeningFlight, AnOrbitGoesOnceRoundTheBoxAndKeepsOutOfIt) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    config::Mission mission = mission_of(house);
    mission.seed = seed;
    EXPECT_EQ(mission.flight.opening, config::Opening::orbit);
    const std::vector<View> views = opening_views(mission);
    ASSERT_EQ(views.size(), 5U);
    EXPECT_GT(nearest(views, unknown_box_of(mission)), mission.flight.clearance + 0.5);
    EXPECT_NEAR(turned(views), 2.0 * M_PI, 1e-9);
    for (const View& view : views) {
      EXPECT_LT(view.direction.dot(view.position), 0.0);  // looks at the middle
    }
  }
}

TEST(OpeningFlight, AnOrbitCirclesOftenEnoughForTheHeightOfTheBox) {
  const config::Mission mission = mission_of(tower);  // 40 m high, looked at from 20 m
  const std::vector<View> views = opening_views(mission);
  EXPECT_NEAR(turned(views), 4.0 * M_PI, 1e-9);
  EXPECT_GT(nearest(views, unknown_box_of(mission)), mission.flight.clearance + 0.5);
  for (std::size_t i = 1; i < views.size(); ++i) {
    const double climbed = views[i].position.z() - views[i - 1].position.z();
    EXPECT_GE(climbed, 0.0);
    EXPECT_LT(climbed, 0.75 * 40.0);
  }
  EXPECT_LT(views.front().position.z(), 0.3 * 40.0);
  EXPECT_GT(views.back().position.z(), 0.85 * 40.0);
  // From farther away more is seen at once; without a bound nothing else would be planned.
  EXPECT_EQ(opening_views(mission_of("{min: [-30, -30, 0], max: [30, 30, 33]}")).size(), 5U);
  EXPECT_LE(opening_views(mission_of("{min: [-1, -1, 0], max: [1, 1, 9000]}")).size(), 129U);
}

TEST(OpeningFlight, StripsLieOverAFlatBoxNoFartherApartThanTheyAreHigh) {
  const config::Mission mission = mission_of(block);
  EXPECT_EQ(mission.flight.opening, config::Opening::strips);
  const std::vector<View> views = opening_views(mission);
  ASSERT_EQ(views.size() % 2, 0U);
  EXPECT_GT(nearest(views, unknown_box_of(mission)), mission.flight.clearance + 0.5);
  EXPECT_LE(120.0 / (0.5 * static_cast<double>(views.size())), views[0].position.z());
  for (std::size_t i = 0; i < views.size(); i += 2) {
    EXPECT_NEAR((views[i + 1].position - views[i].position).norm(), 200.0, 1e-9);  // along
  }
}

TEST(OpeningFlight, IsLeftOutWhereNobodyAsksForIt) {
  EXPECT_TRUE(opening_views(mission_of(tower, ", opening: none")).empty());
  EXPECT_EQ(opening_views(mission_of(tower, ", opening: strips")).size() % 2, 0U);
}

// The speed that a scanner's density allows grows with its turns; half the vehicle's is the most.
TEST(OpeningFlight, FliesSlowerWhereMorePointsAreAskedFor) {
  const double coarse = mission_of(tower).flight.cruise_speed;
  EXPECT_DOUBLE_EQ(coarse, 7.5);  // the m350_rtk flies 15 m/s
  config::Mission fine = mission_of(tower);
  fine.planner.see.spacing = 0.025;
  const double fine_speed = scanning_speed(fine);
  EXPECT_LT(fine_speed, coarse);
  fine.planner.see.spacing = 0.025 * std::sqrt(0.5);
  EXPECT_NEAR(scanning_speed(fine), 0.5 * fine_speed, 1e-9);  // as many rays on half the area
}

}  // namespace
}  // namespace skycap::missions::config
