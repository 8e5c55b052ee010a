#include "sim/sensors/depth_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "sim/sensors/vector_kernels.h"
#include "tests/sim/shapes.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/not_empty.h"

namespace skycap::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Scan;
using testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;

// Returns a camera without noise. Neither 101 nor 67 is a multiple of the size of a packet, tile or
// block.
DepthCameraConfig exact_config(int width = 101, int height = 67) {
  return {.camera = {.width = width,
                     .height = height,
                     .horizontal_fov = 60 * degree,
                     .vertical_fov = 40 * degree,
                     .max_range = 100.0},
          .noise = {},
          .stereo = {}};
}

// Returns a pose with roll and pitch, so that symmetry cannot hide errors.
Isometry3d tilted_pose(const Vector3d& position = {0.5, -0.3, 0.2}) {
  Isometry3d pose = geometry::camera_pose({position, Vector3d(1.0, 0.2, -0.1).normalized()});
  pose.rotate(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(-0.2, Vector3d::UnitX()));
  return pose;
}

std::uint32_t pixel_number(const DepthCamera& camera, int column, int row) {
  return static_cast<std::uint32_t>(row) * camera.camera().width() + column;
}

TEST(DepthCamera, MeasuresTiltedPlaneExactlyInEveryCorner) {
  const Vector3d normal = Vector3d(-1.0, 0.3, 0.2).normalized();
  const Scene scene(square({10, 0, 0}, normal, 100.0), 1);
  const DepthCamera camera(exact_config());
  const Isometry3d pose = tilted_pose();
  const Scan scan = camera.scan(scene, pose, 0, 1);
  ASSERT_EQ(scan.points.size(), 101U * 67U);  // the plane fills the image
  for (const auto& [column, row] : {std::pair{0, 0},
                                    {50, 0},
                                    {100, 0},
                                    {0, 33},
                                    {50, 33},
                                    {100, 33},
                                    {0, 66},
                                    {50, 66},
                                    {100, 66}}) {
    const Vector3d ray = pose.linear() * camera.camera().ray(Vector2d(column, row));
    const double depth = normal.dot(Vector3d(10, 0, 0) - pose.translation()) / normal.dot(ray);
    const Vector3d expected = pose * (depth * camera.camera().ray(Vector2d(column, row)));
    const Vector3d measured = scan.points[pixel_number(camera, column, row)].cast<double>();
    EXPECT_LT((measured - expected).norm(), 1e-4 * (expected - pose.translation()).norm())
        << column << ", " << row;
  }
}

TEST(DepthCamera, MatchesClosedFormRangesToSphere) {
  const Vector3d centre(10, 1, -1);
  const Scene scene(sphere(centre, 3.0, 8), 1);  // sagitta 3 (1 - cos(0.3 deg)) = 4e-5 m
  const DepthCamera camera(exact_config());
  const Isometry3d pose = tilted_pose();
  const Scan scan = camera.scan(scene, pose, 0, 1);
  ASSERT_GT(scan.points.size(), 500U);
  std::size_t compared = 0;
  for (const auto& point : scan.points) {
    const Vector3d measured = point.cast<double>();
    const Vector3d direction = (measured - pose.translation()).normalized();
    const double b = direction.dot(pose.translation() - centre);
    const double c = (pose.translation() - centre).squaredNorm() - 9.0;
    const double expected = -b - std::sqrt(std::max(0.0, b * b - c));
    const double cosine = -direction.dot(measured - centre) / 3.0;
    if (cosine < 0.3) continue;  // the silhouette of the mesh differs from that of the sphere
    EXPECT_NEAR((measured - pose.translation()).norm(), expected, 1e-4 * expected);
    ++compared;
  }
  EXPECT_GT(compared, 400U);
}

// Each return is in the centre of its own pixel, and no pixel with a surface is missing.
TEST(DepthCamera, ReturnsPointsThatProjectToTheirPixels) {
  const Scene scene(sphere({10, 1, -1}, 4.0, 5), 1);
  const DepthCamera camera(exact_config());
  const Isometry3d pose = tilted_pose();
  const Scan scan = camera.scan(scene, pose, 0, 1);
  ASSERT_EQ(scan.points.size(), scan.pixels.size());
  std::size_t next = 0;
  for (int row = 0; row < 67; ++row) {
    for (int column = 0; column < 101; ++column) {
      const Vector3d ray = pose.linear() * camera.camera().ray(Vector2d(column, row));
      if (!scene.first_hit(pose.translation(), ray, 100.0)) continue;
      ASSERT_LT(next, scan.points.size());
      ASSERT_EQ(scan.pixels[next], pixel_number(camera, column, row));
      const auto pixel = camera.camera().project(pose.inverse() * scan.points[next].cast<double>());
      ASSERT_TRUE(pixel);
      EXPECT_NEAR((*pixel - Vector2d(column, row)).norm(), 0.0, 1e-3);
      ++next;
    }
  }
  EXPECT_EQ(next, scan.points.size());
}

TEST(DepthCamera, AppliesRangeLimitsAlongOpticalAxis) {
  DepthCameraConfig config = exact_config();
  config.camera.min_range = 4.0;
  config.camera.max_range = 6.0;
  const DepthCamera camera(config);
  const geometry::View view{{0, 0, 0}, {1, 0, 0}};
  // For a frontal wall, all pixels have the wall's depth, although the range at the corners is 1.2
  // times the depth.
  const auto returns_from_wall_at = [&](double depth) {
    const Scene scene(square({depth, 0, 0}, {-1, 0, 0}, 100.0), 1);
    return camera.scan(scene, view, 0, 1).points.size();
  };
  EXPECT_EQ(returns_from_wall_at(3.99), 0U);
  EXPECT_EQ(returns_from_wall_at(4.01), 101U * 67U);
  EXPECT_EQ(returns_from_wall_at(5.99), 101U * 67U);
  EXPECT_EQ(returns_from_wall_at(6.01), 0U);
}

// The camera touches the ground, so that rays hit it at a distance of zero with either sign. Such
// returns must be neither counted nor written, otherwise later pixels are out of order.
TEST(DepthCamera, IgnoresSurfaceThatItTouches) {
  geometry::Mesh mesh = square({0, 0, 0}, {0, 0, 1}, 40.0);
  geometry::append(mesh, square({3, 0, 0.6}, {-1, 0, 0}, 1.0));
  const Scene scene(mesh, 1);
  const DepthCamera camera(exact_config());
  for (const double height : {0.0, 1e-5, 1e-6, 1e-7, 1e-9, -1e-9, -1e-7, -1e-6}) {
    for (const double slope : {0.0, 0.3, -0.3}) {
      const geometry::View view{{0.1, 0.2, height}, Vector3d(1, 0, slope).normalized()};
      const Scan scan = camera.scan(scene, view, 0, 1);
      EXPECT_TRUE(std::ranges::is_sorted(scan.pixels)) << height << ", " << slope;
      for (const Eigen::Vector3f& point : scan.points) {
        ASSERT_GT((point.cast<double>() - view.position).norm(), 0.0) << height << ", " << slope;
      }
    }
  }
}

TEST(DepthCamera, OccludesSurfacesBehindTooNearSurface) {
  DepthCameraConfig config = exact_config();
  config.camera.min_range = 4.0;
  geometry::Mesh mesh = square({2, 0, 0}, {-1, 0, 0}, 100.0);
  geometry::append(mesh, square({5, 0, 0}, {-1, 0, 0}, 100.0));
  const Scene scene(mesh, 1);
  EXPECT_TRUE(DepthCamera(config).scan(scene, {{0, 0, 0}, {1, 0, 0}}, 0, 1).points.empty());
}

// On a floor seen from a height of 2 m, the incidence angle at distance d is atan(d / 2).
TEST(DepthCamera, ReturnsNoPointsBeyondMaxIncidence) {
  DepthCameraConfig config = exact_config();
  config.max_incidence = 70 * degree;
  const Scene scene(square({0, 0, 0}, {0, 0, 1}, 80.0), 1);
  const geometry::View view{{0, 0, 2}, Vector3d(1, 0, -0.4).normalized()};
  const Scan all = DepthCamera(exact_config()).scan(scene, view, 0, 1);
  const Scan steep = DepthCamera(config).scan(scene, view, 0, 1);
  std::size_t expected = 0;
  for (const auto& point : all.points)
    expected += std::atan(point.head<2>().norm() / 2) < 70 * degree;
  EXPECT_LT(expected, all.points.size());
  EXPECT_EQ(steep.points.size(), expected);
  for (const auto& point : steep.points) {
    EXPECT_LT(std::atan(point.head<2>().norm() / 2), 70.001 * degree);
  }
}

struct Statistics {
  Vector3d mean = Vector3d::Zero(), variance = Vector3d::Zero();
  double skew = 0.0, excess_kurtosis = 0.0;  // of all axes combined
  std::size_t count = 0;
};

// Computes statistics of the differences between a noisy and an exact scan, with `axes` as columns.
template <typename Difference>
Statistics statistics(const Scan& noisy, const Scan& exact, double sigma, Difference difference) {
  Statistics result;
  double third = 0.0, fourth = 0.0;
  result.count = noisy.points.size();
  const auto n = static_cast<double>(result.count);
  for (std::size_t i = 0; i < result.count; ++i) {
    const Vector3d d = difference(noisy.points[i].cast<double>(), exact.points[i].cast<double>());
    result.mean += d / n;
    result.variance += d.cwiseAbs2() / n;
    third += (d / sigma).array().cube().sum() / (3.0 * n);
    fourth += (d / sigma).array().square().square().sum() / (3.0 * n);
  }
  result.skew = third;
  result.excess_kurtosis = fourth - 3.0;
  return result;
}

class NoisyCamera : public testing::Test {
 protected:
  static constexpr double sigma = 0.02;
  const Scene scene{square({10, 0, 0}, Vector3d(-1.0, 0.3, 0.2), 100.0), 1};
  const Isometry3d pose = tilted_pose();
  const Scan exact = DepthCamera(exact_config(640, 400)).scan(scene, pose, 3, 1);

  DepthCamera camera(NoiseDirection direction, std::uint64_t seed = 5) const {
    DepthCameraConfig config = exact_config(640, 400);
    config.noise = {.sigma = sigma, .direction = direction, .seed = seed};
    return DepthCamera(config);
  }
};

// Bounds are four standard deviations of each statistic for N = 256,000 points: sigma / sqrt(N) of
// a mean, sigma^2 sqrt(2/N) of a variance, sqrt(15/3N) and sqrt(96/3N) of the higher moments for
// three axes.
TEST_F(NoisyCamera, HasIsotropicNoiseWithSigmaOnEachAxis) {
  const Scan noisy = camera(NoiseDirection::isotropic).scan(scene, pose, 3, 1);
  ASSERT_EQ(noisy.pixels, exact.pixels);
  const Statistics s = statistics(
      noisy, exact, sigma, [](const Vector3d& a, const Vector3d& b) -> Vector3d { return a - b; });
  const auto n = static_cast<double>(s.count);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(s.mean[axis], 0.0, 4.0 * sigma / std::sqrt(n));
    EXPECT_NEAR(s.variance[axis], sigma * sigma, 4.0 * sigma * sigma * std::sqrt(2.0 / n));
  }
  EXPECT_NEAR(s.skew, 0.0, 4.0 * std::sqrt(15.0 / (3.0 * n)));
  EXPECT_NEAR(s.excess_kurtosis, 0.0, 4.0 * std::sqrt(96.0 / (3.0 * n)));
}

TEST_F(NoisyCamera, HasNoNoiseAcrossRayForAlongRayNoise) {
  const Scan noisy = camera(NoiseDirection::along_ray).scan(scene, pose, 3, 1);
  ASSERT_EQ(noisy.pixels, exact.pixels);
  const Statistics s =
      statistics(noisy, exact, sigma, [&](const Vector3d& a, const Vector3d& b) -> Vector3d {
        const Vector3d along = (b - pose.translation()).normalized();
        const double error = along.dot(a - b);
        EXPECT_LT((a - b - error * along).norm(), 2e-5);  // rounding at 20 m
        return Vector3d::Constant(error);
      });
  const auto n = static_cast<double>(s.count);
  EXPECT_NEAR(s.mean.x(), 0.0, 4.0 * sigma / std::sqrt(n));
  EXPECT_NEAR(s.variance.x(), sigma * sigma, 4.0 * sigma * sigma * std::sqrt(2.0 / n));
  EXPECT_NEAR(s.skew, 0.0, 4.0 * std::sqrt(15.0 / n));
  EXPECT_NEAR(s.excess_kurtosis, 0.0, 4.0 * std::sqrt(96.0 / n));
}

TEST_F(NoisyCamera, HasNoiseThatDependsOnFrameAndSeed) {
  const DepthCamera first = camera(NoiseDirection::isotropic);
  const Scan scan = first.scan(scene, pose, 3, 1);
  EXPECT_EQ(first.scan(scene, pose, 3, 1).points, scan.points);
  EXPECT_NE(first.scan(scene, pose, 4, 1).points, scan.points);
  EXPECT_NE(camera(NoiseDirection::isotropic, 6).scan(scene, pose, 3, 1).points, scan.points);
}

// A frontal wall at depth z has the disparity f B / z, with an error of s px and multiples of the
// step. For 256,000 pixels, four standard deviations of the variance are 1.1%. The square of the
// step over 12 is added.
TEST(DepthCamera, HasStereoErrorsOfDisparity) {
  DepthCameraConfig config = exact_config(640, 400);
  config.stereo = {.focal_length_px = 424.0,
                   .baseline = 0.05,
                   .disparity_sigma_px = 0.08,
                   .disparity_step_px = 1.0 / 32};
  for (const double depth : {1.0, 2.0, 4.0}) {
    const Scene scene(square({depth, 0, 0}, {-1, 0, 0}, 100.0), 1);
    const Scan scan = DepthCamera(config).scan(scene, {{0, 0, 0}, {1, 0, 0}}, 2, 1);
    ASSERT_EQ(scan.points.size(), 640U * 400U);
    double mean = 0.0, variance = 0.0;
    for (const auto& point : scan.points) {
      const double disparity = 424.0 * 0.05 / point.x();
      EXPECT_NEAR(disparity * 32.0, std::round(disparity * 32.0), 1e-3);
      const double error = disparity - 424.0 * 0.05 / depth;
      mean += error / 256'000;
      variance += error * error / 256'000;
    }
    const double expected = 0.08 * 0.08 + 1.0 / (32 * 32 * 12);
    EXPECT_NEAR(mean, 0.0, 4.0 * std::sqrt(expected / 256'000));
    EXPECT_NEAR(variance, expected, 0.011 * expected);
  }
}

// Includes rows and tiles without returns, which change the output offsets of the bands.
TEST(DepthCamera, DoesNotDependOnThreadCount) {
  const Scene scene(sphere({10, 1, -1}, 2.0, 5), 2);
  DepthCameraConfig config = exact_config(501, 333);
  config.noise = {.sigma = 0.01, .seed = 9};
  const DepthCamera camera(config);
  const Scan expected = camera.scan(scene, tilted_pose(), 1, 1);
  ASSERT_GT(expected.points.size(), 10'000U);
  for (const unsigned threads : {2U, 4U, 7U}) {
    const Scan scan = camera.scan(scene, tilted_pose(), 1, threads);
    EXPECT_EQ(scan.points, expected.points) << threads;
    EXPECT_EQ(scan.pixels, expected.pixels) << threads;
  }
}

TEST(DepthCamera, IsIndependentOfReusedScan) {
  const Scene scene(sphere({10, 1, -1}, 2.0, 5), 1);
  const DepthCamera camera(exact_config());
  const Scan expected = camera.scan(scene, tilted_pose(), 1, 1);
  Scan used = DepthCamera(exact_config(400, 300)).scan(scene, tilted_pose(), 5, 1);
  const Scan scan = camera.scan(scene, tilted_pose(), 1, 1, std::move(used));
  EXPECT_EQ(scan.points, expected.points);
  EXPECT_EQ(scan.pixels, expected.pixels);
}

// Tests the kernel that computes the points on each instruction set, with and without gaps in the
// row.
TEST(DepthCamera, ReturnsSamePointsOnAllInstructionSets) {
  constexpr std::size_t width = 333;
  std::vector<float> depth(width), column(width);
  for (std::size_t i = 0; i < width; ++i) {
    depth[i] = i % 97 < 40 || i % 7 == 0 ? 5.0F + 0.01F * static_cast<float>(i) : -1.0F;
    column[i] = 0.003F * static_cast<float>(i) - 0.5F;
  }
  PinholeRow row{.width = width,
                 .depth = depth.data(),
                 .column = {column.data(), column.data(), column.data()},
                 .row = {0.1F, 0.2F, 1.0F},
                 .origin = {1.0F, 2.0F, 3.0F},
                 .first_pixel = 1000,
                 .sigma = 0.01F,
                 .noise_direction = NoiseDirection::isotropic,
                 .noise_keys = {noise_key(1, 0, 0), noise_key(1, 1, 0), noise_key(1, 2, 0)},
                 .noise_index = 64};
  const auto emit = [&](const VectorKernels& kernels) {
    std::vector<float> points(3 * width);
    std::vector<std::uint32_t> pixels(width);
    const std::size_t written = kernels.emit_row(row, points.data(), pixels.data());
    points.resize(3 * written);
    pixels.resize(written);
    return std::pair(points, pixels);
  };
  for (const auto direction : {NoiseDirection::isotropic, NoiseDirection::along_ray}) {
    row.noise_direction = direction;
    const auto expected = emit(baseline_kernels);
    EXPECT_GT(expected.second.size(), 100U);
    for (const geometry::InstructionSet set : testing_support::not_empty(instruction_sets())) {
      const InstructionSetLimit limit(set);
      EXPECT_EQ(emit(vector_kernels()), expected) << static_cast<int>(set);
    }
  }
}

// Known values: 1200 / tan 30 and 875 / tan 20; 424 / tan 34.7 and 240 / tan 21.25.
TEST(DepthCamera, HasPublishedGeometryInPresets) {
  const DepthCamera high(high_resolution()), small(d435());
  EXPECT_NEAR(high.camera().focal_length_px().x(), 2078.46, 0.01);
  EXPECT_NEAR(high.camera().focal_length_px().y(), 2404.04, 0.01);
  EXPECT_EQ(high.camera().width() * high.camera().height(), 2400 * 1750);
  EXPECT_NEAR(small.camera().focal_length_px().x(), 612.33, 0.01);
  EXPECT_NEAR(small.camera().focal_length_px().y(), 617.16, 0.01);
  EXPECT_EQ(small.config().noise.sigma, 0.01);
}

TEST(DepthCamera, RejectsZeroMaxIncidence) {
  DepthCameraConfig config = exact_config();
  config.max_incidence = 0.0;
  try {
    const DepthCamera camera(config);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_config);
    EXPECT_THAT(error.what(), HasSubstr("max_incidence is 0"));
  }
}

}  // namespace
}  // namespace skycap::sim
