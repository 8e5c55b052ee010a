/// Closed-form depth camera for spheres, for tests of planners without the simulator.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/pose.h"

namespace skycap::tests {

struct Sphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.5;
};

/// Returns the scan of a depth camera of some spheres within its range, with or without noise.
inline geometry::Scan scan_spheres(const std::vector<Sphere>& spheres,
                                   const geometry::Camera& camera, const geometry::View& view,
                                   double sigma = 0.0, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  geometry::Scan scan;
  scan.world_from_sensor = geometry::camera_pose(view);
  for (int row = 0; row < camera.height(); ++row) {
    for (int column = 0; column < camera.width(); ++column) {
      const Eigen::Vector3d direction =
          (scan.world_from_sensor.linear() * camera.ray({column, row})).normalized();
      double nearest = INFINITY;
      for (const Sphere& sphere : spheres) {
        const Eigen::Vector3d offset = view.position - sphere.centre;
        const double b = offset.dot(direction);
        const double discriminant = b * b - offset.squaredNorm() + sphere.radius * sphere.radius;
        if (discriminant < 0.0) continue;
        const double distance = -b - std::sqrt(discriminant);
        if (distance > 0.0) nearest = std::min(nearest, distance);
      }
      const double depth = nearest * direction.dot(scan.world_from_sensor.linear().col(2));
      if (!(depth >= camera.config().min_range && depth <= camera.config().max_range)) continue;
      Eigen::Vector3d point = view.position + nearest * direction;
      for (int axis = 0; axis < 3; ++axis) point[axis] += sigma * noise(random);
      scan.points.push_back(point.cast<float>());
      scan.pixels.push_back(static_cast<std::uint32_t>(row * camera.width() + column));
    }
  }
  return scan;
}

}  // namespace skycap::tests
