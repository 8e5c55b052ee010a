/// Point sets that several tests use.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Core>

namespace skycap::tests {

/// Returns points distributed uniformly in the cube [-half_edge, half_edge]^3.
inline std::vector<Eigen::Vector3f> random_points(std::size_t count, double half_edge,
                                                  std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> coordinate(static_cast<float>(-half_edge),
                                                   static_cast<float>(half_edge));
  std::vector<Eigen::Vector3f> points(count);
  for (Eigen::Vector3f& p : points)
    p = {coordinate(random), coordinate(random), coordinate(random)};
  return points;
}

/// Returns points on the unit sphere with normal noise `sigma` on each coordinate, ordered along a
/// spiral from the pole like a simple scan.
inline std::vector<Eigen::Vector3f> noisy_sphere(std::size_t count, double sigma,
                                                 std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, sigma);
  std::vector<Eigen::Vector3f> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
    const double azimuth = 2.399963229728653 * static_cast<double>(i);
    const double radius = std::sqrt(1.0 - z * z);
    Eigen::Vector3d p(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
    for (int axis = 0; axis < 3; ++axis) p[axis] += noise(random);
    points[i] = p.cast<float>();
  }
  return points;
}

}  // namespace skycap::tests
