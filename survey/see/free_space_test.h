/// Tests whether measured lines of sight pass a position. SEE uses this to find the free side of a
/// surface.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/spatial_index.h"

namespace skycap::survey::see {

/// Points of a scan, indexed by their direction from the sensor.
class FreeSpaceTest {
 public:
  FreeSpaceTest(std::span<const Eigen::Vector3f> points, const Eigen::Vector3d& sensor)
      : sensor_(sensor), directions_(chord) {
    for (const Eigen::Vector3f& point : points) {
      const Eigen::Vector3d ray = point.cast<double>() - sensor;
      directions_.insert(ray.normalized().cast<float>());
      ranges_.push_back(ray.norm());
    }
  }
  /// Returns whether all measurements in the direction of `position` are behind it. Returns false
  /// without measurements in that direction.
  bool is_free(const Eigen::Vector3d& position) const {
    const Eigen::Vector3d ray = position - sensor_;
    const auto near = directions_.within(ray.normalized().cast<float>(), chord);
    return !near.empty() && std::all_of(near.begin(), near.end(), [&](std::uint32_t index) {
      return ranges_[index] > ray.norm();
    });
  }
  /// Returns whether the side of a surface at `position` opposite to `normal` is free. Tests both
  /// sides, the front side first, every `step` up to `limit`, until one is found to be free.
  bool is_free_behind(const Eigen::Vector3d& position, const Eigen::Vector3d& normal, double step,
                      double limit) const {
    double along = step;
    while (along <= limit) {
      if (is_free(position + along * normal)) return false;
      if (is_free(position - along * normal)) return true;
      along += step;
    }
    return false;
  }

 private:
  static constexpr double chord = 0.01;  // maximum chord between unit directions on the same line
  Eigen::Vector3d sensor_;
  geometry::SpatialIndex directions_;
  std::vector<double> ranges_;
};

}  // namespace skycap::survey::see
