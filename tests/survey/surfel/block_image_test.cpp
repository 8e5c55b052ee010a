#include "survey/surfel/block_image.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/not_empty.h"
#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const geometry::Camera camera{geometry::CameraConfig{.width = 212, .height = 120}};
const geometry::View front = geometry::look_at({2.0, 0.0, 0.0}, {0, 0, 0});
const std::vector<tests::Sphere> ball = {{}};  // radius 0.5 around the origin

TEST(BlockImage, ComputesCountAndMeanOfReturns) {
  const geometry::Scan scan = tests::scan_spheres(ball, camera, front);
  const surfel::BlockImage image =
      surfel::make_block_image(scan, camera, {.block_px = 4, .jump = 10.0F});
  std::vector<Vector3f> sums(image.blocks.size(), Vector3f::Zero());
  std::vector<std::uint32_t> counts(image.blocks.size());
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const std::uint32_t row = scan.pixels[i] / 212 / 4, column = scan.pixels[i] % 212 / 4;
    sums[row * 53 + column] += scan.points[i];
    ++counts[row * 53 + column];
  }
  ASSERT_FALSE(image.blocks.empty());
  for (std::size_t b = 0; b < image.blocks.size(); ++b) {
    ASSERT_EQ(image.blocks[b].returns, counts[b]);
    if (counts[b] == 0) continue;
    // Single-precision sum of sixteen numbers of magnitude 1.
    EXPECT_LT((image.blocks[b].mean - sums[b] / static_cast<float>(counts[b])).norm(), 1e-5F);
    const auto hit = image.projection.project(image.blocks[b].mean);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->block, b);
  }
}

TEST(BlockImage, HasRadialNormalsOnSphere) {
  const geometry::Scan scan = tests::scan_spheres(ball, camera, front);
  const surfel::BlockImage image =
      surfel::make_block_image(scan, camera, {.block_px = 4, .jump = 0.2F});
  int tested = 0;
  for (const surfel::Block& block : testing_support::not_empty(image.blocks)) {
    const Vector3f radial = block.mean.normalized();
    if (block.returns < 16 || radial.x() < 0.5F)
      continue;  // beyond 60 degrees windows are asymmetric
    // 11 degrees: a window covers 25 degrees of the sphere.
    EXPECT_GT(block.normal.dot(radial), 0.98F);
    ++tested;
  }
  EXPECT_GT(tested, 100);
}

// A large ball is behind a small one. Blocks on the outline of the small ball contain only that
// ball.
TEST(BlockImage, KeepsNearerSurfaceInEdgeBlocks) {
  const std::vector<tests::Sphere> two = {{{0.5, 0, 0}, 0.2}, {{-5, 0, 0}, 3.0}};
  const geometry::Scan scan = tests::scan_spheres(two, camera, front);
  const surfel::BlockImage image =
      surfel::make_block_image(scan, camera, {.block_px = 4, .jump = 1.0F});
  int edges = 0;
  for (const surfel::Block& block : testing_support::not_empty(image.blocks)) {
    if (!block.is_edge) continue;
    ++edges;
    EXPECT_LT((block.mean - Vector3f(0.5F, 0, 0)).norm(), 0.21F);
  }
  EXPECT_GT(edges, 10);
}

// On a surface perpendicular to the optical axis at distance z, there are f_x f_y / z^2 rays per
// square metre.
TEST(BlockImage, HasRayDensityOfPinholeCamera) {
  const std::vector<tests::Sphere> wall = {{{-1000.0, 0, 0}, 1000.0}};
  const surfel::BlockImage image =
      surfel::make_block_image(tests::scan_spheres(wall, camera, front), camera, {.block_px = 4});
  const surfel::Block& middle = image.blocks[15 * 53 + 26];
  const double expected = camera.focal_length_px().prod() / 4.0;
  EXPECT_NEAR(image.ray_density(middle, middle.mean, 1.0F), expected, 0.01 * expected);
}

// The same returns without pixels: the cube faces contain each return once. The ray density, which
// is now counted, equals that of the camera.
TEST(BlockImage, SortsSweepIntoCubeFaces) {
  geometry::Scan scan = tests::scan_spheres(ball, camera, front);
  const surfel::BlockImage organised =
      surfel::make_block_image(scan, camera, {.block_px = 8, .jump = 0.2F});
  const surfel::Block& middle = organised.blocks[7 * 27 + 13];
  scan.pixels.clear();
  const auto faces = surfel::make_cube_images(scan, camera, 32, {.jump = 10.0F});
  std::size_t returns = 0;
  double density = 0.0, blocks = 0.0;
  for (const surfel::BlockImage& face : faces) {
    for (const surfel::Block& block : face.blocks) {
      returns += block.returns;
      if (block.returns == 0 || (block.mean - middle.mean).norm() > 0.15F) continue;
      density += face.ray_density(block, block.mean, 1.0F);
      blocks += 1.0;
    }
  }
  EXPECT_EQ(returns, scan.points.size());
  const double expected = organised.ray_density(middle, middle.mean, 1.0F);
  EXPECT_NEAR(density / blocks, expected, 0.15 * expected);  // a block has 11 to 16 whole rays
}

// A miss is only known where the sensor is known to have fired: inside the camera's view. No block
// extends beyond it.
TEST(BlockImage, MarksSweepMissesOnlyInFront) {
  geometry::Scan scan = tests::scan_spheres(ball, camera, front);
  scan.pixels.clear();
  const auto faces = surfel::make_cube_images(scan, camera, 32, {.jump = 10.0F});
  ASSERT_EQ(faces.size(), 1U);  // all returns are in front
  const surfel::BlockProjection& p = faces[0].projection;
  int scanned = 0;
  for (int row = 0; row < p.rows; ++row) {
    for (int column = 0; column < p.columns; ++column) {
      const auto is_in_view = [&](int right, int down) {
        const Eigen::Vector2f slope(
            (static_cast<float>(column + right) - p.principal_point.x()) / p.focal_length.x(),
            (static_cast<float>(row + down) - p.principal_point.y()) / p.focal_length.y());
        return camera.project({0.999 * slope.x(), 0.999 * slope.y(), 1.0}).has_value();
      };
      const bool is_wholly_in_view =
          is_in_view(0, 0) && is_in_view(1, 0) && is_in_view(0, 1) && is_in_view(1, 1);
      const surfel::Block& block =
          faces[0].blocks[static_cast<std::size_t>(row * p.columns + column)];
      EXPECT_EQ(block.is_scanned, is_wholly_in_view) << "row " << row << ", column " << column;
      scanned += block.is_scanned ? 1 : 0;
    }
  }
  EXPECT_GT(scanned, 100);
}

TEST(BlockImage, DoesNotDependOnThreadCount) {
  const geometry::Scan scan = tests::scan_spheres(ball, camera, front, 0.01);
  const surfel::BlockImage one = surfel::make_block_image(scan, camera, {.threads = 1});
  const surfel::BlockImage three = surfel::make_block_image(scan, camera, {.threads = 3});
  ASSERT_FALSE(one.blocks.empty());
  for (std::size_t b = 0; b < one.blocks.size(); ++b) {
    ASSERT_EQ(one.blocks[b].mean, three.blocks[b].mean);
    ASSERT_EQ(one.blocks[b].normal, three.blocks[b].normal);
  }
}

}  // namespace
}  // namespace skycap::survey
