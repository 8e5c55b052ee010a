/// Point cloud with a minimum point spacing, as stored by every planner.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/spaced_points.h"

namespace skycap::missions::evaluation {

class DownsampledCloud {
 public:
  explicit DownsampledCloud(double spacing) : kept_(spacing) {}

  /// Stores the points inside `box` that are farther than the spacing from all stored points. An
  /// empty box is unlimited. Returns the stored points.
  std::vector<Eigen::Vector3f> store(std::span<const Eigen::Vector3f> points,
                                     const Eigen::AlignedBox3d& box) {
    std::vector<Eigen::Vector3f> stored;
    for (const Eigen::Vector3f& point : points) {
      if (!box.isEmpty() && !box.contains(point.cast<double>())) continue;
      if (kept_.keep(point)) stored.push_back(point);
    }
    return stored;
  }

 private:
  geometry::SpacedPoints kept_;
};

}  // namespace skycap::missions::evaluation
