// Measurements with closed-form results, in addition to the tests of the individual sensors.
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/points/depth_image.h"
#include "geometry/pose/pose.h"
#include "sim/sensors/depth_camera.h"
#include "sim/sensors/lidar.h"
#include "tests/sim/packets.h"
#include "tests/sim/shapes.h"

namespace skycap::sim {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;

std::vector<Vector3d> random_directions(int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    directions.push_back(Vector3d{normal(random), normal(random), normal(random)}.normalized());
  }
  return directions;
}

/// Returns the lateral surface of an upright cylinder around the z axis, with its vertices on the
/// cylinder, facing outward.
geometry::Mesh cylinder(double radius, double half_height, int sides) {
  geometry::Mesh mesh;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * pi * i / sides;
    for (const double z : {-half_height, half_height}) {
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  const auto n = static_cast<std::uint32_t>(2 * sides);
  for (std::uint32_t i = 0; i < n; i += 2) {
    mesh.triangles.push_back({i, (i + 2) % n, (i + 3) % n});
    mesh.triangles.push_back({i, (i + 3) % n, i + 1});
  }
  return mesh;
}

// |o + t d| = r across the axis. From outside, the tessellated surface is behind the true one, by
// at most the sagitta r (1 - cos(pi / n)) over the cosine of the incidence. From inside it is in
// front.
TEST(ClosedForm, MatchesRangesToCylinder) {
  constexpr double radius = 5.0;
  constexpr int sides = 360;
  const Scene scene(cylinder(radius, 10.0, sides), 1);
  const double sagitta = radius * (1.0 - std::cos(pi / sides));
  int from_outside = 0;
  for (const double distance : {12.0, 2.0}) {
    const Vector3d origin(distance, 0.3, 0.7);
    for (const Vector3d& direction : random_directions(4000, 7)) {
      const double a = direction.head<2>().squaredNorm();
      const double b = direction.head<2>().dot(origin.head<2>());
      const double c = origin.head<2>().squaredNorm() - radius * radius;
      const double root = b * b - a * c;
      if (root < 0.0 || (c > 0.0 && b > 0.0)) continue;
      const double range = (c > 0.0 ? -b - std::sqrt(root) : -b + std::sqrt(root)) / a;
      const Vector3d point = origin + range * direction;
      const double cosine = std::abs(direction.head<2>().dot(point.head<2>())) / radius;
      if (cosine < 0.1 ||  // facet normals deviate by up to half a degree: 9% there
          std::abs(point.z()) > 9.0)
        continue;
      const auto hit = scene.first_hit(origin, direction);
      ASSERT_TRUE(hit);
      const double longer = c > 0.0 ? hit->distance - range : range - hit->distance;
      const double rounding = 1e-5 / cosine;  // single precision for triangles 20 m long
      EXPECT_GE(longer, -rounding);
      EXPECT_LE(longer, sagitta / cosine * 1.1 + rounding);
      from_outside += c > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(from_outside, 200);
}

// Inside a box, the range is the minimum of three plane distances. This includes edges and corners,
// where two or three are equal. All ranges are exact to single precision.
TEST(ClosedForm, MatchesRangesInsideBox) {
  const Scene scene(cube({1, 2, 3}, 8.0), 1);
  const Vector3d origin(0.5, 1.0, 4.0);
  std::vector<Vector3d> directions = random_directions(2000, 3);
  for (int corner = 0; corner < 27; ++corner) {  // corners, middles of edges, middles of faces
    const Vector3d sign(corner % 3 - 1, corner / 3 % 3 - 1, corner / 9 - 1);
    if (sign.isZero()) continue;
    directions.push_back((Vector3d(1, 2, 3) + 4.0 * sign - origin).normalized());
  }
  for (const Vector3d& direction : directions) {
    double range = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
      const double wall = Vector3d(1, 2, 3)[axis] + (direction[axis] > 0 ? 4.0 : -4.0);
      if (direction[axis] != 0.0) range = std::min(range, (wall - origin[axis]) / direction[axis]);
    }
    const auto hit = scene.first_hit(origin, direction);
    ASSERT_TRUE(hit) << direction.transpose();
    EXPECT_NEAR(hit->distance, range, 1e-5 * range) << direction.transpose();
  }
}

// Rays in random order, some of which miss: single rays and packets are bitwise equal.
TEST(ClosedForm, MatchesSingleRaysAndPackets) {
  const geometry::Mesh ball = sphere({3, 0, 0}, 2.0, 6);
  const Scene scene(ball, 1);
  const Vector3d origin(-5, 0.1, 0.2);
  const std::vector<Vector3d> offsets = random_directions(4096, 11);
  RayPacket packet;
  int hits = 0;
  for (std::size_t first = 0; first < offsets.size(); first += RayPacket::width) {
    for (int lane = 0; lane < RayPacket::width; ++lane) {
      aim(packet, lane, scene, origin, Vector3d(8, 0, 0) + 3.0 * offsets[first + lane]);
    }
    ray_kernels().cast(scene.trees().target, packet, RayPacket::all_lanes, 1000.0F);
    for (int lane = 0; lane < RayPacket::width; ++lane) {
      SingleRay ray = {};
      for (int axis = 0; axis < 3; ++axis) {
        ray.origin[axis] = packet.origin[axis][lane];
        ray.direction[axis] = packet.direction[axis][lane];
      }
      ray_kernels().cast_single(scene.trees().target, ray, 1000.0F);
      ASSERT_EQ(packet.distance[lane], ray.distance);
      EXPECT_EQ(ray_kernels().is_blocked(scene.trees().target, ray, 1000.0F), ray.distance >= 0.0F);
      if (ray.distance < 0.0F) continue;
      ++hits;
      EXPECT_EQ(packet.triangle[lane], ray.triangle);
    }
  }
  EXPECT_GT(hits, 1000);
  EXPECT_LT(hits, 4000);
}

// A beam with full angle gamma hits a plane tilted by theta. The ranges in the footprint of a
// Gaussian beam have a spread of sigma = gamma R / 4 tan(theta). Seven rays, with the outer six at
// the 1/e^2 radius and weight e^-2, have the variance (gamma R tan(theta) / 2)^2 3 e^-2 / (1 + 6
// e^-2): 0.947 of the Gaussian sigma. The pulse is so short that each ray gives a separate echo.
TEST(ClosedForm, MatchesEchoSpreadOnTiltedPlane) {
  constexpr double range = 80.0, gamma = 0.002;
  LidarConfig config;
  config.rotation_rate = 0.0;
  config.beam = {.rings = 1,
                 .divergence_horizontal = gamma,
                 .divergence_vertical = gamma,
                 .pulse_length = 1e-15,
                 .max_returns = 15};
  const Trajectory standing(
      {{0.0, {0, 0, 0}, Quaterniond::Identity()}, {1.0, {0, 0, 0}, Quaterniond::Identity()}});
  for (const double theta : {20 * degree, 50 * degree, 70 * degree}) {
    const Vector3d normal(-std::cos(theta), std::sin(theta), 0.0);
    const Scene scene(square({range, 0, 0}, normal, 100.0), 1);
    const LidarReturns returns = Lidar(config).measure(scene, {standing, standing}, {0, 1});
    ASSERT_GE(returns.size(), 4U);  // rays above and below the axis have the same range
    double weight = 0.0, mean = 0.0, square_mean = 0.0;
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const double energy = returns.intensities[i];
      // Reconstructs the position where the ray hit the plane. Points are reported along the beam's
      // axis.
      const double measured = (returns.origin + returns.true_points[i].cast<double>()).norm();
      weight += energy;
      mean += energy * measured;
      square_mean += energy * (measured - range) * (measured - range);
    }
    mean /= weight;
    const double spread = std::sqrt(square_mean / weight - (mean - range) * (mean - range));
    const double exact = 0.5 * gamma * range * std::tan(theta) *
                         std::sqrt(3 * std::exp(-2.0) / (1 + 6 * std::exp(-2.0)));
    // Second order in gamma: the far side of the footprint is farther from the axis than the near
    // side.
    EXPECT_NEAR(spread, exact, 0.01 * exact) << theta;
    EXPECT_NEAR(exact, 0.947 * 0.25 * gamma * range * std::tan(theta), 1e-3 * exact);
  }
}

// A line scanner looks straight down. Along the track, lines are v / (lines per second) apart.
// Across it, pulses are h dtheta / cos^2(theta) apart. The mean density is the fraction of pulses
// inside the field of view over the area that they sweep.
TEST(ClosedForm, MatchesSpacingAndDensityOfLineScanner) {
  constexpr double height = 60.0, speed = 8.0, field = 80 * degree;
  LidarConfig config;
  config.firing_period = 1.0 / 40'000;
  config.rotation_rate = 50.0;
  config.field_of_view = field;
  config.max_range = 500.0;
  // The rotation axis points in flight direction. The x axis, the middle of the field of view,
  // points down.
  Isometry3d mount = Isometry3d::Identity();
  mount.linear().col(0) = -Vector3d::UnitZ();
  mount.linear().col(1) = Vector3d::UnitY();
  mount.linear().col(2) = Vector3d::UnitX();
  const Scene scene(square({0, 0, 0}, {0, 0, 1}, 2000.0), 1);
  constexpr double duration = 2.0;
  const Trajectory trajectory({{0.0, {0, 0, height}, Quaterniond::Identity()},
                               {duration, {speed * duration, 0, height}, Quaterniond::Identity()}});
  const Lidar lidar(config);
  const LidarReturns returns =
      lidar.measure(scene, {trajectory, trajectory, mount, mount}, {0, 80'000});

  const double step = 2 * pi * config.rotation_rate * config.firing_period;
  std::vector<double> nadirs;  // along the track
  ASSERT_GT(returns.size(), 1U);
  for (std::size_t i = 1; i < returns.size(); ++i) {
    const Vector3d before = returns.origin + returns.points[i - 1].cast<double>();
    const Vector3d after = returns.origin + returns.points[i].cast<double>();
    if (returns.times[i] - returns.times[i - 1] > 1.5 * config.firing_period) continue;
    const double theta = 0.5 * std::abs(returns.scan_angles[i] + returns.scan_angles[i - 1]);
    const double expected = height * step / (std::cos(theta) * std::cos(theta));
    // The formula is the derivative. Over a step of 0.45 degrees its error is a few 1e-5.
    ASSERT_NEAR(std::abs(after.y() - before.y()), expected, 2e-4 * expected + 4e-5);
    if (before.y() < 0 && after.y() >= 0) nadirs.push_back(after.x());
  }
  ASSERT_GT(nadirs.size(), 90U);
  for (std::size_t i = 1; i < nadirs.size(); ++i) {
    EXPECT_NEAR(nadirs[i] - nadirs[i - 1], speed / config.rotation_rate, 1e-3);
  }
  const double share = field / (2 * pi);
  const double area = speed * duration * 2 * height * std::tan(field / 2);
  const double density = static_cast<double>(returns.size()) / area;
  const double expected = share / config.firing_period / (speed * 2 * height * std::tan(field / 2));
  // 800 pulses per revolution, 178 +- 1 inside the field of view.
  EXPECT_NEAR(density, expected, 0.01 * expected);
}

/// Returns four units in the last place of a single-precision number of this magnitude.
double four_ulp(double size) {
  const auto single = static_cast<float>(size);
  return 4.0 * static_cast<double>(std::nextafter(single, 2.0F * single) - single);
}

DepthCamera exact_camera() {
  return DepthCamera({.camera = {.width = 101,
                                 .height = 67,
                                 .horizontal_fov = 60 * degree,
                                 .vertical_fov = 40 * degree,
                                 .max_range = 500.0},
                      .noise = {},
                      .stereo = {}});
}

// n . p = c for each return, with a rotated and tilted sensor. The remaining error is the rounding
// of a coordinate of 100 m, of the direction and distance, and of the plane's corners, 350 m from
// its centre.
TEST(ClosedForm, MatchesPointsOnTiltedPlane) {
  const Vector3d normal = Vector3d(-1.0, 0.3, 0.2).normalized(), middle(100, 5, -3);
  const Scene scene(square(middle, normal, 500.0), 1);
  Isometry3d pose = geometry::camera_pose({{0.5, -0.3, 0.2}, Vector3d(1.0, 0.2, -0.1)});
  pose.rotate(AngleAxisd(0.3, Vector3d::UnitZ()));
  const geometry::Scan scan = exact_camera().scan(scene, pose, 0, 1);
  ASSERT_EQ(scan.points.size(), 101U * 67U);
  for (const Vector3f& point : scan.points) {
    const double range = (point.cast<double>() - pose.translation()).norm();
    ASSERT_LT(std::abs(normal.dot(point.cast<double>() - middle)),
              four_ulp(range) + 0.25 * four_ulp(350.0));
  }
}

// Straight down, all depths equal the height, although ranges grow with 1 / cosine.
TEST(ClosedForm, MatchesDepthOfNadirView) {
  constexpr double height = 80.0;
  const Scene scene(square({0, 0, 0}, {0, 0, 1}, 1000.0), 1);
  const Isometry3d pose = geometry::camera_pose({{3, 4, height}, Vector3d(0, 0, -1)});
  const DepthCamera camera = exact_camera();
  const geometry::Scan scan = camera.scan(scene, pose, 0, 1);
  ASSERT_EQ(scan.points.size(), 101U * 67U);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Vector3d seen = pose.inverse() * scan.points[i].cast<double>();
    ASSERT_NEAR(seen.z(), height, four_ulp(height));
    const Eigen::Vector2d pixel(scan.pixels[i] % 101, scan.pixels[i] / 101);
    const double cosine = 1.0 / camera.camera().ray(pixel).norm();
    ASSERT_NEAR(seen.norm(), height / cosine, four_ulp(height / cosine));
  }
}

// From inside, a tessellated sphere is never farther than the sphere. It is closer by at most the
// sagitta over the cosine of the incidence.
TEST(ClosedForm, MatchesRangesInsideSphere) {
  constexpr double radius = 20.0;
  constexpr int splits = 5;
  const Scene scene(sphere({0, 0, 0}, radius, splits), 1);
  const double edge_angle = 1.75 * 0.5 * pi / (1 << splits);
  const double sagitta = radius * (1.0 - std::cos(edge_angle / std::sqrt(3.0)));
  const Vector3d origin(5, -3, 2);
  for (const Vector3d& direction : random_directions(2000, 8)) {
    const double b = direction.dot(origin), c = origin.squaredNorm() - radius * radius;
    const double distance = -b + std::sqrt(b * b - c);
    const double cosine = direction.dot(origin + distance * direction) / radius;
    const auto hit = scene.first_hit(origin, direction);
    ASSERT_TRUE(hit);
    EXPECT_LT(hit->distance, distance + 1e-5);  // single precision at 25 m
    EXPECT_GT(hit->distance, distance - 1.1 * sagitta / cosine - 1e-5);
  }
}

// A depth image contains the noise of its points exactly once: sigma along the axis for a frontal
// wall. The tolerance is four standard deviations of the estimate from N pixels. Steps of 0.1 mm
// are negligible.
TEST(ClosedForm, MatchesNoiseOfDepthImage) {
  constexpr double sigma = 0.01, wall = 6.0, unit = 1e-4;
  const Scene scene(square({wall, 0, 0}, {-1, 0, 0}, 100.0), 1);
  DepthCameraConfig config = exact_camera().config();
  config.camera.width = 400;
  config.camera.height = 300;
  config.noise.sigma = sigma;
  const DepthCamera camera(config);
  const geometry::Scan scan = camera.scan(scene, geometry::View{{0, 0, 0}, {1, 0, 0}}, 0, 1);
  const geometry::DepthImage image = geometry::depth_image(scan, camera.camera(), unit);
  const auto n = static_cast<double>(image.values.size());
  double sum = 0.0, squares = 0.0;
  for (const std::uint16_t value : image.values) {
    const double error = unit * value - wall;
    sum += error;
    squares += error * error;
  }
  EXPECT_NEAR(sum / n, 0.0, 4.0 * sigma / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), sigma, 4.0 * sigma / std::sqrt(2.0 * n));
}

}  // namespace
}  // namespace skycap::sim
