#include "survey/surfel/raster/visibility_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "geometry/pose/pose.h"
#include "survey/surfel/raster/depth_raster.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;

constexpr std::size_t count = 1003;  // not a multiple of a vector length

class VisibilityKernels : public testing::Test {
 protected:
  VisibilityKernels() {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<float> coordinate(-4.0F, 4.0F);
    for (auto* points : {&positions, &normals}) {
      for (auto& axis : *points) {
        for (std::size_t i = 0; i < count; ++i) axis.push_back(coordinate(random));
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      const float length = std::hypot(normals[0][i], normals[1][i], normals[2][i]);
      for (auto& axis : normals) axis[i] /= length;
    }
    for (int axis = 0; axis < 3; ++axis) {
      raster.position[axis] = static_cast<float>(view.position[axis]);
      raster.right[axis] = static_cast<float>(axes(axis, 0));
      raster.down[axis] = static_cast<float>(axes(axis, 1));
      raster.forward[axis] = static_cast<float>(axes(axis, 2));
    }
  }

  static surfel::PointArrays to_arrays(const std::array<std::vector<float>, 3>& points) {
    return {points[0].data(), points[1].data(), points[2].data()};
  }
  Vector3d in_camera(std::size_t i) const {
    const Vector3d point(positions[0][i], positions[1][i], positions[2][i]);
    return axes.transpose() * (point - view.position);
  }
  Vector3d normal(std::size_t i) const {
    return axes.transpose() * Vector3d(normals[0][i], normals[1][i], normals[2][i]);
  }

  const geometry::View view = geometry::look_at({-5.0, 0.5, 1.0}, {0.0, 0.0, 0.0});
  const Eigen::Matrix3d axes = geometry::camera_pose(view).linear();
  std::array<std::vector<float>, 3> positions, normals;
  surfel::RasterView raster{.focal_length = 40.0F,
                            .width = 60.0F,
                            .height = 50.0F,
                            .stride = 62 + surfel::row_margin,
                            .outside = (62 + surfel::row_margin) * 52,
                            .half_slope = {0.75F, 0.62F},
                            .min_range = 2.0F,
                            .max_range = 7.0F,
                            .min_cosine = 0.2F};
};

// Reference in double precision. Coordinates within 0.001 of a pixel's edge may be rounded either
// way.
TEST_F(VisibilityKernels, ProjectPointsLikePinholeCamera) {
  std::vector<std::uint32_t> pixels(count);
  std::vector<float> depths(count);
  std::vector<std::int32_t> sizes(count);
  surfel::project_points(raster, count, to_arrays(positions), 0.1F,
                         {pixels.data(), depths.data(), sizes.data()});
  int inside = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d p = in_camera(i);
    EXPECT_NEAR(depths[i], p.z(), 1e-5);
    const double column = 40.0 * p.x() / p.z() + 30.0, row = 40.0 * p.y() / p.z() + 25.0;
    const auto is_near_edge = [](double x) {
      return std::abs(x + 0.5 - std::round(x + 0.5)) < 1e-3;
    };
    if (is_near_edge(column) || is_near_edge(row) || is_near_edge(column + 0.5) ||
        is_near_edge(row + 0.5)) {
      continue;
    }
    const bool is_inside =
        p.z() > 0.0 && column >= 0.0 && row >= 0.0 && column < 60.0 && row < 50.0;
    const double pixel = std::floor(row + 0.5) * raster.stride + std::floor(column + 0.5);
    EXPECT_EQ(pixels[i], is_inside ? pixel : raster.outside) << "point " << i;
    inside += is_inside ? 1 : 0;
    // At 40 px per metre, 0.1 m are four pixels. The size is twice that, and an eighth of it at 8
    // m.
    if (is_inside) {
      EXPECT_NEAR(sizes[i], std::max(2.0, std::ceil(8.0 / p.z() - 1e-5)), 0.0) << "point " << i;
    }
  }
  EXPECT_GT(inside, 300);
}

// Reference: each square drawn pixel by pixel. Some points are only a few centimetres away, where
// squares are wider than the raster.
TEST_F(VisibilityKernels, DrawDepthsOfNearestSquares) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<float> nearness(0.02F, 1.0F);
  for (std::size_t i = 0; i < count; ++i) {
    const float share = i % 3 == 0 ? nearness(random) * nearness(random) : 1.0F;
    for (int axis = 0; axis < 3; ++axis) {
      float& x = positions[static_cast<std::size_t>(axis)][i];
      x = raster.position[axis] + share * (x - raster.position[axis]);
    }
  }
  std::vector<std::uint32_t> pixels(count);
  std::vector<float> depths(count);
  std::vector<std::int32_t> sizes(count);
  surfel::DepthRaster drawn;
  for (const float spacing : {0.1F, 0.02F, 0.3F}) {
    surfel::project_points(raster, count, to_arrays(positions), spacing,
                           {pixels.data(), depths.data(), sizes.data()});
    drawn.draw(raster, count, to_arrays(positions), spacing);
    std::vector<float> expected(raster.outside, std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < count; ++i) {
      if (pixels[i] == raster.outside) continue;
      const int pixel = static_cast<int>(pixels[i]), before = (sizes[i] - 2) / 2;
      const int row = pixel / raster.stride - before, column = pixel % raster.stride - before;
      for (int r = std::max(0, row); r < std::min(52, row + sizes[i]); ++r) {
        for (int c = std::max(0, column); c < std::min(62, column + sizes[i]); ++c) {
          float& depth = expected[static_cast<std::size_t>(r * raster.stride + c)];
          depth = std::min(depth, depths[i]);
        }
      }
    }
    for (int row = 0; row < 52; ++row) {
      for (int column = 0; column < 62; ++column) {
        const auto pixel = static_cast<std::uint32_t>(row * raster.stride + column);
        ASSERT_EQ(drawn.depth(pixel), expected[pixel]) << row << ' ' << column << ' ' << spacing;
      }
    }
    EXPECT_GT(*std::ranges::max_element(sizes), spacing > 0.05F ? 60 : surfel::largest_window);
  }
}

TEST_F(VisibilityKernels, FindTargetsThatFaceSensorInsideFrustum) {
  std::vector<std::uint32_t> in_view(count), pixels(count);
  std::vector<float> depths(count), cosines(count), densities(count), slopes(count);
  surfel::project_targets(raster, 1e4F, count, to_arrays(positions), to_arrays(normals),
                          {in_view.data(), pixels.data(), depths.data(), cosines.data(),
                           densities.data(), slopes.data()});
  std::uint32_t seen = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d p = in_camera(i);
    const double cosine = -p.normalized().dot(normal(i));
    EXPECT_NEAR(cosines[i], cosine, 1e-5);
    const std::array<double, 5> margins = {p.z() - 2.0, 7.0 - p.z(), 0.75 * p.z() - std::abs(p.x()),
                                           0.62 * p.z() - std::abs(p.y()), cosine - 0.2};
    const double min = *std::ranges::min_element(margins);
    if (std::abs(min) < 1e-4) continue;  // single precision may decide differently
    EXPECT_EQ(in_view[i], min > 0.0 ? 1U : 0U) << "target " << i;
    if (in_view[i] == 0) {
      EXPECT_EQ(pixels[i], raster.outside);
    }
    // A pixel off the axis covers a smaller part of the sphere, by the cube of its angle's cosine.
    if (in_view[i] != 0) {
      EXPECT_NEAR(densities[i], 1e4 * cosine * std::pow(p.norm() / p.z(), 3) / p.squaredNorm(),
                  1e-4 * densities[i]);
      EXPECT_NEAR(slopes[i], std::min(4.0, std::tan(std::acos(cosine))), 1e-3);
    }
    seen += in_view[i];
  }
  EXPECT_GT(seen, 50U);
}

}  // namespace
}  // namespace skycap::survey
