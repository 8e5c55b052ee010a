#include "missions/evaluation/evaluation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/evaluation/coverage.h"
#include "sim/sensors/depth_camera.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Returns a cube around the origin, oriented outward.
geometry::Mesh cube(double half) {
  geometry::Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Returns a cube with edges of 2 m and a smaller one inside, which is not visible from outside.
geometry::Mesh cube_in_a_cube() {
  geometry::Mesh mesh = cube(1.0);
  geometry::append(mesh, cube(0.3));
  return mesh;
}

const evaluation::Admissible from_anywhere{
    .view_distance = 4.0, .allows = {}, .directions = 200, .clearance = 1e-4};

TEST(VisibleSamples, IncludeOnlyOuterSurface) {
  const geometry::Mesh mesh = cube_in_a_cube();
  const sim::Scene scene(mesh);
  const auto samples = geometry::sample_surface(mesh, 3000, 1);
  const auto is_visible = evaluation::visible_samples(samples.points, scene, from_anywhere);
  ASSERT_FALSE(samples.points.empty());
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const bool is_outside = samples.points[i].cwiseAbs().maxCoeff() > 0.9F;
    ASSERT_EQ(is_visible[i], is_outside ? 1 : 0) << samples.points[i].transpose();
  }
}

// From z >= 0, the bottom of a cube on the plane z = 0 is not visible.
TEST(VisibleSamples, RespectAdmissibleViews) {
  geometry::Mesh mesh = cube(1.0);
  geometry::transform(mesh, Eigen::Affine3d(Eigen::Translation3d(0, 0, 1)));
  const sim::Scene scene(mesh);
  const auto samples = geometry::sample_surface(mesh, 3000, 1);
  evaluation::Admissible above = from_anywhere;
  above.allows = [](const geometry::View& view) { return view.position.z() >= 0.0; };
  const auto is_visible = evaluation::visible_samples(samples.points, scene, above);
  ASSERT_FALSE(samples.points.empty());
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    ASSERT_EQ(is_visible[i], samples.normals[i].z() > -0.5F ? 1 : 0);
  }
}

TEST(VisibleSamples, AreSameForAnyThreadCount) {
  const geometry::Mesh mesh = cube_in_a_cube();
  const sim::Scene scene(mesh);
  const auto samples = geometry::sample_surface(mesh, 5000, 1);
  EXPECT_EQ(evaluation::visible_samples(samples.points, scene, from_anywhere, 1),
            evaluation::visible_samples(samples.points, scene, from_anywhere, 3));
}

evaluation::CaptureScan quick_scans(const sim::Scene& scene) {
  sim::DepthCameraConfig config = sim::d435();
  config.camera.width = 212;
  config.camera.height = 120;
  config.noise.sigma = 0.0;
  return [&scene, camera = sim::DepthCamera(config)](const geometry::View& view,
                                                     std::uint64_t frame, geometry::Scan buffer) {
    return camera.scan(scene, view, frame, 1, std::move(buffer));
  };
}

// With a spacing well below r_d and without noise, the whole visible surface is attainable. The
// inner cube, 0.09 / 1.09 of the area, is not.
TEST(AttainableCoverage, IsVisibleFractionWithoutOtherLimits) {
  const geometry::Mesh mesh = cube_in_a_cube();
  const sim::Scene scene(mesh);
  const auto samples = geometry::sample_surface(mesh, 3000, 1);
  const auto is_visible = evaluation::visible_samples(samples.points, scene, from_anywhere);
  const evaluation::AttainableConfig config{
      .views = 60, .spacing = 0.02, .registration_distance = 0.1, .box = {}};
  const double attainable_coverage = evaluation::marked_share(evaluation::attainable_samples(
      samples.points, is_visible, scene, quick_scans(scene), from_anywhere, config));
  EXPECT_NEAR(attainable_coverage, 1.0 / 1.09, 1e-3);  // one sample is 3e-4
}

// If the spacing exceeds r_d, gaps remain between the stored points. The densest packing has at
// most one disc of radius r_d for each spacing^2 sqrt(3)/2.
TEST(AttainableCoverage, IsLimitedByPointSpacing) {
  const geometry::Mesh mesh = cube(1.0);
  const sim::Scene scene(mesh);
  const auto samples = geometry::sample_surface(mesh, 3000, 1);
  const auto is_visible = evaluation::visible_samples(samples.points, scene, from_anywhere);
  const evaluation::AttainableConfig config{
      .views = 40, .spacing = 0.2, .registration_distance = 0.1, .box = {}};
  const double attainable_coverage = evaluation::marked_share(evaluation::attainable_samples(
      samples.points, is_visible, scene, quick_scans(scene), from_anywhere, config));
  EXPECT_LT(attainable_coverage, std::numbers::pi * 0.01 / (0.04 * std::sqrt(3.0) / 2.0));
  EXPECT_GT(attainable_coverage, 0.5);  // random packings cover 0.55 of the plane
}

TEST(AttainableCoverage, ExcludesSurfaceOutsideBox) {
  const geometry::Mesh mesh = cube(1.0);
  const sim::Scene scene(mesh);
  const auto samples = geometry::sample_surface(mesh, 3000, 1);
  const auto is_visible = evaluation::visible_samples(samples.points, scene, from_anywhere);
  evaluation::AttainableConfig config{
      .views = 60, .spacing = 0.02, .registration_distance = 0.05, .box = {}};
  config.box = Eigen::AlignedBox3d(Vector3d(-2, -2, 0), Vector3d(2, 2, 2));
  const double attainable_coverage = evaluation::marked_share(evaluation::attainable_samples(
      samples.points, is_visible, scene, quick_scans(scene), from_anywhere, config));
  // The upper half, and a rim of r_d below z = 0 on four sides with a width of 2: 0.4 / 24 of the
  // area.
  EXPECT_NEAR(attainable_coverage, 0.5 + 0.4 / 24.0, 4e-3);
}

}  // namespace
}  // namespace skycap::missions
