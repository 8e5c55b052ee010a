#include "flight/clearance/obstacles.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/clearance/clearance.h"
#include "geometry/error.h"
#include "tests/flight/scenes.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

std::string error_message(const Obstacles& obstacles) {
  return testing_support::thrown_message([&] { validate(obstacles); });
}

const std::vector<Vector2d> square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
const std::vector<Vector2d> l_shape{{0, 0}, {40, 0}, {40, 10}, {10, 10}, {10, 40}, {0, 40}};

TEST(Obstacles, AreValidWhenEmpty) { EXPECT_EQ(error_message({}), ""); }

TEST(Obstacles, ReportTheInvalidPart) {
  Obstacles two_corners;
  two_corners.no_fly = {{"pad", {{0, 0}, {1, 0}}}};
  EXPECT_THAT(error_message(two_corners), HasSubstr("no-fly volume \"pad\" has 2 corners"));
  Obstacles bow_tie;
  bow_tie.no_fly = {{"tie", {{0, 0}, {10, 10}, {10, 0}, {0, 10}}}};
  EXPECT_THAT(error_message(bow_tie), HasSubstr("crosses itself"));
  Obstacles flat;
  flat.fence = Prism{"line", {{0, 0}, {5, 0}, {10, 0}}};
  EXPECT_THAT(error_message(flat), HasSubstr("fence \"line\" has no area"));
  Obstacles upside_down;
  upside_down.fence = Prism{"site", square, 50, 20};
  EXPECT_THAT(error_message(upside_down), HasSubstr("must be below its ceiling"));
  Obstacles buried;
  buried.fence = Prism{"site", square, 0, 20};
  buried.ground_height = 30.0;
  EXPECT_THAT(error_message(buried), HasSubstr("must be above the ground"));
  Obstacles bad_point;
  bad_point.cloud.points = {{0, 0, std::numeric_limits<float>::quiet_NaN()}};
  EXPECT_THAT(error_message(bad_point), HasSubstr("obstacle point 0"));
  Obstacles bad_radius;
  bad_radius.cloud.radius = -1;
  EXPECT_THAT(error_message(bad_radius), HasSubstr("zero or more"));
  Obstacles no_triangles;
  no_triangles.mesh.vertices = {{0, 0, 0}};
  EXPECT_THAT(error_message(no_triangles), HasSubstr("no triangle"));
}

// Compares the point-in-polygon test in the plane with the winding number of the closed surface.
TEST(Prism, ContainsPointsWithPositiveWindingNumber) {
  std::mt19937_64 random(4);
  for (const bool clockwise : {false, true}) {
    Prism prism{"L", l_shape, 3, 20};
    if (clockwise) std::reverse(prism.footprint.begin(), prism.footprint.end());
    Obstacles obstacles;
    obstacles.mesh = surface(prism);
    EXPECT_NEAR(geometry::surface_area(obstacles.mesh), 2 * 700 + 160 * 17, 1e-9);
    const KnownSpace space(obstacles);
    for (int i = 0; i < 500; ++i) {
      const Vector3d p = scenes::point_in(random, {Vector3d(-5, -5, 0), Vector3d(45, 45, 25)});
      EXPECT_EQ(contains(prism, p), space.winding_number(p) > 0.5) << p.transpose();
    }
  }
}

TEST(Prism, TriangulatesFootprintWithCollinearCorners) {
  const Prism prism{"T", {{0, 0}, {5, 0}, {10, 0}, {10, 5}, {10, 10}, {5, 10}, {0, 10}}, 0, 1};
  EXPECT_NEAR(geometry::surface_area(surface(prism)), 2 * 100 + 40, 1e-9);
}

}  // namespace
}  // namespace skycap::flight
