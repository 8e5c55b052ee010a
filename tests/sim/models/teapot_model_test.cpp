#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "sim/models/teapot.h"
#include "sim/scene/scene.h"

namespace skycap::sim::models {
namespace {

using Eigen::Vector3d;

// Newell's published extents. The spout's curve ends at 3.434; its control points extend to 3.525.
TEST(Teapot, MatchesPublishedExtents) {
  const Eigen::AlignedBox3d box = bounding_box(teapot(16));
  EXPECT_NEAR(box.min().x(), -3.0, 1e-9);
  EXPECT_NEAR(box.max().x(), 3.434, 1e-3);
  EXPECT_NEAR(box.min().y(), -2.0, 1e-9);
  EXPECT_NEAR(box.max().y(), 2.0, 1e-9);
  EXPECT_NEAR(box.min().z(), 0.0, 1e-9);
  EXPECT_NEAR(box.max().z(), 3.15, 1e-9);
}

// 32 patches of 16 x 16 cells have 16,384 triangles. At the poles of the knob and the bottom, one
// side of a patch is a point. There, 16 triangles collapse in each of 8 patches.
TEST(Teapot, MergesPatchesAndRemovesCollapsedTriangles) {
  const geometry::Mesh mesh = teapot(16);
  EXPECT_EQ(mesh.triangles.size(), 32U * 16 * 16 * 2 - 8 * 16);
  // Merged vertices: no two have the same position, and all are used.
  std::set<std::array<double, 3>> positions;
  for (const Vector3d& v : mesh.vertices) {
    positions.insert({std::round(1e7 * v.x()), std::round(1e7 * v.y()), std::round(1e7 * v.z())});
  }
  EXPECT_EQ(positions.size(), mesh.vertices.size());
  std::set<std::uint32_t> used;
  for (const auto& triangle : mesh.triangles) used.insert(triangle.begin(), triangle.end());
  EXPECT_EQ(used.size(), mesh.vertices.size());
}

TEST(Teapot, ConvergesToSmoothSurfaceUnderRefinement) {
  // The chord error decreases with the square of the chord length.
  const double coarse = surface_area(teapot(8)), middle = surface_area(teapot(16)),
               fine = surface_area(teapot(32));
  EXPECT_NEAR((middle - coarse) / (fine - middle), 4.0, 0.3);
}

TEST(Teapot, FacesOutward) {
  const Scene scene(teapot(16));
  // Level rays at the body and the lid from all sides, and a ray at the knob from above.
  for (const double z : {0.3, 1.0, 2.0, 2.6}) {
    for (const Vector3d& from : {Vector3d(9, 9, z), Vector3d(-9, 9, z), Vector3d(0.1, -9, z)}) {
      const Vector3d direction = Vector3d(0, 0, z) - from;
      const auto hit = scene.first_hit(from, direction);
      ASSERT_TRUE(hit);
      EXPECT_LT(hit->normal.dot(direction), 0.0) << from.transpose();
    }
  }
  const auto knob = scene.first_hit({0.01, 0.02, 9}, {0, 0, -1});
  ASSERT_TRUE(knob);
  EXPECT_GT(knob->normal.z(), 0.9);
}

TEST(Teapot, RejectsCellCountOutOfRange) {
  try {
    teapot(0);
    FAIL() << "accepted 0 cells";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("0 cells"));
    EXPECT_EQ(error.kind(), ErrorKind::bad_config);
  }
}

}  // namespace
}  // namespace skycap::sim::models
