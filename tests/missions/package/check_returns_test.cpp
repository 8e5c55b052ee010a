#include "missions/package/verification/check_returns.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/clearance/clearance.h"
#include "missions/config/vehicle_reader.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

// A wall of 40 m stands between the route and the rally point. Both landing points are equally far
// from the end of the route, so that the autopilot may select either.
TEST(CheckReturns, VerifiesReturnsToRallyPoints) {
  flight::Obstacles wall;
  wall.mesh_is_solid = false;
  wall.mesh.vertices = {{45, -20, 0}, {45, 20, 0}, {45, 20, 40}, {45, -20, 40}};
  wall.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const flight::KnownSpace space(wall);
  flight::FlightOptions options{.vehicle = config::find_vehicle("generic"), .clearance = 2.0};
  options.takeoff = Vector3d::Zero();
  const std::vector<Vector3d> route{{0, 0, 10}, {30, 0, 10}, {0, 0, 10}};
  const auto check = [&] { return check_returns("mission.plan", 20.0, options, space, route); };
  EXPECT_TRUE(check().is_safe) << check().text;
  options.rally = {Vector3d(60, 0, 0)};
  EXPECT_FALSE(check().is_safe);
  EXPECT_THAT(check().text, HasSubstr("not verified: at 20 m (--return-altitude)"));
  options.rally = {Vector3d(30, 30, 0)};
  EXPECT_TRUE(check().is_safe) << check().text;
}

}  // namespace
}  // namespace skycap::missions::package
