#include "geometry/surfaces/mesh.h"

#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/support/complaint.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

/// Returns two triangles in the plane z = 0 with areas 0.5 and 1.5 and no shared vertices.
Mesh two_triangles() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {8, 0, 0}, {5, 1, 0}},
          {{0, 1, 2}, {3, 4, 5}}};
}

std::string error_message(const Mesh& mesh) {
  return testing_support::thrown_message([&] { validate(mesh); });
}

TEST(Mesh, MeasuresAreaAndBoxOfUsedVertices) {
  Mesh mesh = two_triangles();
  mesh.vertices.emplace_back(99, 99, 99);  // not used by a triangle
  EXPECT_DOUBLE_EQ(surface_area(mesh), 2.0);
  EXPECT_EQ(bounding_box(mesh).max(), Vector3d(8, 1, 0));
}

TEST(Mesh, ReportsTheInvalidElement) {
  EXPECT_EQ(error_message(two_triangles()), "");
  Mesh bad_index = two_triangles();
  bad_index.triangles[1][2] = 6;
  EXPECT_THAT(error_message(bad_index), HasSubstr("triangle 1 has vertex 6"));
  Mesh not_finite = two_triangles();
  not_finite.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_message(not_finite), HasSubstr("vertex 3"));
  EXPECT_THAT(error_message(Mesh{}), HasSubstr("no triangle"));
}

TEST(Mesh, KeepsOrientationUnderReflection) {
  Mesh mesh = two_triangles();
  transform(mesh, Eigen::Affine3d(Eigen::Scaling(1.0, 1.0, -1.0)));
  const SurfaceSamples samples = sample_surface(mesh, 1, 1);
  EXPECT_GT(-samples.normals[0].z(), 0.0);  // the original faces +z, so the mirrored mesh faces -z
}

TEST(Mesh, KeepsBothPartsWhenAppended) {
  Mesh mesh = two_triangles();
  append(mesh, two_triangles());
  EXPECT_DOUBLE_EQ(surface_area(mesh), 4.0);
  EXPECT_EQ(mesh.triangles[3][0], 9U);
}

// Stratified sampling: the number of samples in each triangle is proportional to its area, within
// two.
TEST(SampleSurface, IsUniformInAreaAndRepeatable) {
  const SurfaceSamples samples = sample_surface(two_triangles(), 4000, 42);
  ASSERT_EQ(samples.points.size(), 4000U);
  Vector3d sum = Vector3d::Zero();
  int in_first = 0;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const Eigen::Vector3f& p = samples.points[i];
    EXPECT_FLOAT_EQ(p.z(), 0.0F);
    if (samples.triangles[i] == 0) {
      ++in_first;
      EXPECT_LE(p.x() + p.y(), 1.0F + 1e-6F);
      sum += p.cast<double>();
    }
  }
  EXPECT_NEAR(in_first, 1000, 2);
  // Mean of n uniform samples: the centroid within 5 sigma/sqrt(n), sigma = sqrt(1/18).
  EXPECT_LT((sum / in_first - Vector3d(1, 1, 0) / 3).norm(), 5 * std::sqrt(2.0 / 18 / 1000));
  EXPECT_EQ(sample_surface(two_triangles(), 4000, 42).points, samples.points);
  EXPECT_NE(sample_surface(two_triangles(), 4000, 43).points, samples.points);
}

}  // namespace
}  // namespace skycap::geometry
