#include "missions/scan/scan_route.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/trajectory_file.h"
#include "geometry/error.h"
#include "geometry/pose/pose.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using geometry::View;

constexpr double pi = std::numbers::pi;

// At any time, the platform is on the circle or climbing, at the set speed, with its nose in flight
// direction.
TEST(OrbitTrajectory, KeepsRadiusSpeedAndHeading) {
  const scan::OrbitOptions orbit{.centre = {5, -3, 2},
                                 .radius = 20,
                                 .min_height = 10,
                                 .max_height = 40,
                                 .circles = 4,
                                 .speed = 5,
                                 .start = 0.5};
  const sim::Trajectory trajectory = scan::orbit_trajectory(orbit);
  const double length = 4 * 2 * pi * 20 + 30;
  EXPECT_NEAR(trajectory.end(), length / 5, 1e-9);
  EXPECT_TRUE(trajectory.pose(0).translation().isApprox(
      Vector3d(5 + 20 * std::cos(0.5), -3 + 20 * std::sin(0.5), 12), 1e-12));
  EXPECT_NEAR(trajectory.pose(trajectory.end()).translation().z(), 42, 1e-9);
  const double round_time = 2 * pi * 20 / 5, climb_time = 2;
  for (double time = 0.1; time < trajectory.end() - 0.1; time += 0.37) {
    const Isometry3d pose = trajectory.pose(time);
    const Vector3d spoke = pose.translation() - orbit.centre;
    EXPECT_NEAR(spoke.head<2>().norm(), 20, 1e-3) << time;  // chords of 0.1 m
    const double in_round = std::fmod(time, round_time + climb_time);
    if (in_round > 0.1 && in_round < round_time - 0.1) {
      const Vector3d velocity = (trajectory.pose(time + 0.05).translation() -
                                 trajectory.pose(time - 0.05).translation()) /
                                0.1;
      EXPECT_NEAR(velocity.norm(), 5, 1e-3) << time;
      EXPECT_GT(velocity.normalized().dot(pose.linear().col(0)), 0.9999) << time;
      EXPECT_NEAR(std::remainder(spoke.z(), 10), 0, 1e-9) << time;
    }
    EXPECT_TRUE(pose.linear().col(2).isApprox(Vector3d::UnitZ(), 1e-9)) << time;
  }
}

TEST(OrbitTrajectory, FliesSingleCircleAtMinHeight) {
  const sim::Trajectory trajectory = scan::orbit_trajectory(
      {.radius = 10, .min_height = 3, .max_height = 9, .circles = 1, .speed = 2});
  EXPECT_NEAR(trajectory.end(), 2 * pi * 10 / 2, 1e-9);
  EXPECT_NEAR(trajectory.pose(5).translation().z(), 3, 1e-12);
}

class ScanRouteFile : public testing::Test {
 protected:
  // Checks that a camera on a platform at a view has the view's direction.
  static void expect_view(const sim::Trajectory& platform, double time, const View& view) {
    const View seen = geometry::to_view(platform.pose(time) * scan::body_from_camera());
    EXPECT_TRUE(seen.position.isApprox(view.position, 1e-5)) << seen.position.transpose();
    EXPECT_TRUE(seen.direction.isApprox(view.direction, 1e-5)) << seen.direction.transpose();
  }

  const tests::TestFolder folder{};
  scan::ScanFlightOptions options;
  const View first = geometry::look_at({10, 0, 5}, {0, 0, 3});
  const View second = geometry::look_at({10, 8, 5}, {0, 0, 9});
};

TEST_F(ScanRouteFile, KeepsTimesAndPosesOfTumTrajectory) {
  const std::string file =
      folder.write("flight.tum", flight::write_tum({{2.0, geometry::camera_pose(first)},
                                                    {3.5, geometry::camera_pose(second)}}));
  const scan::ScanRoute route = scan::read_scan_route(file, options, scan::Platform::airframe);
  EXPECT_EQ(route.platform.start(), 2.0);
  EXPECT_EQ(route.platform.end(), 3.5);
  EXPECT_TRUE(route.image_times.empty());
  expect_view(route.platform, 2.0, first);
  expect_view(route.platform, 3.5, second);
}

TEST_F(ScanRouteFile, FliesStraightBetweenViewsAtSetSpeed) {
  options.speed = 4.0;
  folder.write("views.csv",
               "view,x,y,z,direction_x,direction_y,direction_z,points\n"
               "0,10,0,5,-1,0,0,7\n1,10,8,5,-1,0,0,9\n2,10,8,5,0,-1,0,9\n");
  const scan::ScanRoute route =
      scan::read_scan_route(folder.path(), options, scan::Platform::gimbal);
  // 8 m at 4 m/s, then a rotation by 90 degrees at 1 rad/s.
  EXPECT_THAT(route.image_times, testing::Pointwise(testing::DoubleNear(1e-9),
                                                    std::vector<double>{0.0, 2.0, 2.0 + 0.5 * pi}));
  EXPECT_TRUE(route.platform.pose(1.0).translation().isApprox(Vector3d(10, 4, 5), 1e-9));
  expect_view(route.platform, 2.0, {{10, 8, 5}, {-1, 0, 0}});
}

TEST_F(ScanRouteFile, KeepsAirframeLevelWhenGimbalPitches) {
  std::vector<flight::TimedState> states(2);
  states[0].position = {1, 2, 30};
  states[0].yaw = 0.5 * pi;  // east
  states[0].pitch = -0.8;
  states[1] = states[0];
  states[1].time = 4.0;
  states[1].is_capture = true;
  const std::string file =
      folder.write("trajectory.csv", flight::write_trajectory_csv(states, flight::Frame::enu));
  const scan::ScanRoute gimbal = scan::read_scan_route(file, options, scan::Platform::gimbal);
  expect_view(gimbal.platform, 1.0, {{1, 2, 30}, {std::cos(0.8), 0, -std::sin(0.8)}});
  EXPECT_THAT(gimbal.image_times, testing::ElementsAre(testing::DoubleNear(4.0, 1e-6)));
  const scan::ScanRoute airframe = scan::read_scan_route(file, options, scan::Platform::airframe);
  EXPECT_TRUE(airframe.platform.pose(1.0).linear().isApprox(Eigen::Matrix3d::Identity(), 1e-5));
}

/// Returns a trajectory of two seconds between two positions, with a capture at its end.
std::string sortie(const Vector3d& from, const Vector3d& to, double start) {
  std::vector<flight::TimedState> states(2);
  states[0].time = start;
  states[0].position = from;
  states[1].time = start + 2.0;
  states[1].position = to;
  states[1].is_capture = true;
  return flight::write_trajectory_csv(states, flight::Frame::enu);
}

TEST_F(ScanRouteFile, FliesAllSortiesOfPackageInSequence) {
  folder.write("views.csv",
               "view,x,y,z,direction_x,direction_y,direction_z,points\n0,10,0,5,-1,0,0,7\n");
  folder.write("mission-1.csv", sortie({0, 0, 10}, {4, 0, 10}, 6.5));
  folder.write("mission-2.csv", sortie({0, 0, 10}, {0, 8, 10}, 6.5));
  options.speed = 2.0;
  const scan::ScanRoute route =
      scan::read_scan_route(folder.path(), options, scan::Platform::airframe);
  // 4 m from the end of the first trajectory to the start of the second.
  EXPECT_THAT(route.image_times, testing::Pointwise(testing::DoubleNear(1e-6),
                                                    std::vector<double>{8.5, 8.5 + 2.0 + 2.0}));
  EXPECT_TRUE(route.platform.pose(7.5).translation().isApprox(Vector3d(2, 0, 10), 1e-6));
  EXPECT_TRUE(route.platform.pose(11.5).translation().isApprox(Vector3d(0, 4, 10), 1e-6));
  EXPECT_NEAR(route.platform.end(), 12.5, 1e-6);
}

// Straight lines between the views of a survey with a vehicle may cross the scene.
TEST_F(ScanRouteFile, RejectsFlightPackageWithoutTrajectory) {
  folder.write("views.csv",
               "view,x,y,z,direction_x,direction_y,direction_z,points\n0,10,0,5,-1,0,0,7\n");
  folder.write("free_space.bin", "");
  const std::string error_message = testing_support::thrown_message(
      [&] { scan::read_scan_route(folder.path(), options, scan::Platform::airframe); });
  EXPECT_THAT(error_message,
              testing::HasSubstr("contains a flight, but no mission.csv; export one"));
}

// 2e-5 degrees of longitude at the equator: 2.2264 m on WGS84.
TEST_F(ScanRouteFile, FliesGeodeticWaypointsNoseForward) {
  const std::string file =
      folder.write("route.waypoints",
                   "QGC WPL 110\n"
                   "0\t1\t0\t16\t0\t0\t0\t0\t0.0000000\t0.0010000\t0.000000\t1\n"
                   "1\t0\t3\t22\t0\t0\t0\t0\t0.0000000\t0.0010000\t10.000000\t1\n"
                   "2\t0\t3\t16\t0\t0\t0\t0\t0.0000000\t0.0010200\t10.000000\t1\n"
                   "3\t0\t3\t16\t0\t0\t0\t0\t0.0000000\t0.0010200\t12.000000\t1\n"
                   "4\t0\t3\t21\t0\t0\t0\t0\t0.0000000\t0.0010200\t0.000000\t1\n");
  try {
    scan::read_scan_route(file, options, scan::Platform::airframe);
    FAIL() << "read without a georeference";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("set site.latitude_deg and site.longitude_deg"));
  }
  options.site = flight::Site{};
  options.site->origin.longitude_deg = 1e-3;
  options.speed = 2.0;
  const scan::ScanRoute route = scan::read_scan_route(file, options, scan::Platform::airframe);
  const double distance = 2e-5 * pi / 180.0 * 6378137.0;
  EXPECT_NEAR(route.platform.end() - route.platform.start(), (distance + 2.0) / 2.0, 0.01);
  const Isometry3d last = route.platform.pose(route.platform.end());
  EXPECT_TRUE(last.translation().isApprox(Vector3d(distance, 0, 12), 1e-3));
  EXPECT_TRUE(last.linear().isApprox(Eigen::Matrix3d::Identity(), 1e-6));  // still to the east
  EXPECT_TRUE(route.image_times.empty());
}

TEST_F(ScanRouteFile, ReportsInvalidRoutes) {
  const auto message = [&](const std::string& name, const std::string& content) -> std::string {
    try {
      scan::read_scan_route(folder.write(name, content), options, scan::Platform::gimbal);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_file);
      return error.what();
    }
    return "read";
  };
  using testing::HasSubstr;
  EXPECT_THAT(message("a.tum", "1 2 3\n"), HasSubstr("a.tum: "));
  EXPECT_THAT(message("a.csv", "view,x\n0,1\n"), HasSubstr("a.csv: line 2 has 2 fields"));
  EXPECT_THAT(message("b.csv", "view,x\n0,1,2,3,0,0,0\n"), HasSubstr("of zero length"));
  EXPECT_THAT(message("c.csv", "view,x\n0,1,2,x,0,0,1\n"), HasSubstr("line 2"));
  EXPECT_THAT(message("d.csv", "view,x\n"), HasSubstr("the trajectory has no poses"));
  options.site = flight::Site{.origin = {0.1, 0.1, 0.0}};
  EXPECT_THAT(message("a.plan", "{}"), HasSubstr("a.plan"));
}

}  // namespace
}  // namespace skycap::missions
