/// Whether a measured sight line passes a place: SEE's test of which side of a surface is free.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/spatial_index.h"

namespace skycap::survey::see {

/// All points of a scan, as directions from the sensor.
class SeenThrough {
 public:
  SeenThrough(std::span<const Eigen::Vector3f> points, const Eigen::Vector3d& sensor)
      : sensor_(sensor), directions_(chord) {
    for (const Eigen::Vector3f& point : points) {
      const Eigen::Vector3d ray = point.cast<double>() - sensor;
      directions_.insert(ray.normalized().cast<float>());
      ranges_.push_back(ray.norm());
    }
  }
  /// Whether every measurement along the line to `place` is from behind it. False if there is none.
  bool is_free(const Eigen::Vector3d& place) const {
    const Eigen::Vector3d ray = place - sensor_;
    const auto near = directions_.within(ray.normalized().cast<float>(), chord);
    return !near.empty() && std::all_of(near.begin(), near.end(), [&](std::uint32_t index) {
      return ranges_[index] > ray.norm();
    });
  }
  /// Whether of the two sides of a surface through `place` the one behind is free. Both are probed,
  /// the front first, every `step` as far as `limit`, until one turns out to be.
  bool is_free_behind(const Eigen::Vector3d& place, const Eigen::Vector3d& normal, double step,
                      double limit) const {
    double along = step;
    while (along <= limit) {
      if (is_free(place + along * normal)) return false;
      if (is_free(place - along * normal)) return true;
      along += step;
    }
    return false;
  }

 private:
  static constexpr double chord = 0.01;  // between unit directions that count as the same line
  Eigen::Vector3d sensor_;
  geometry::SpatialIndex directions_;
  std::vector<double> ranges_;
};

}  // namespace skycap::survey::see
