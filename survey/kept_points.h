/// Points of a survey at the planner's spacing, for planners that need the stored cloud only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/points/point_cloud.h"
#include "geometry/points/scan.h"
#include "geometry/points/spaced_points.h"

namespace skycap::survey {

class KeptPoints {
 public:
  /// `spacing` is the minimum distance of stored points [m]. Points outside `box` are ignored.
  KeptPoints(double spacing, const std::optional<Eigen::AlignedBox3d>& box)
      : box_(box), kept_(spacing, std::max(2.0 * spacing, 1e-6)) {}

  /// Stores the points of the next scan and returns their number.
  std::size_t add(const geometry::ScanSpan& scan) {
    const std::size_t before = cloud_.size();
    for (const Eigen::Vector3f& point : scan.points) {
      if (!contains(point) || !kept_.keep(point)) continue;
      cloud_.positions.push_back(point);
      cloud_.views.push_back(scans_);
    }
    ++scans_;
    return cloud_.size() - before;
  }

  /// Returns whether a point is part of the scene.
  bool contains(const Eigen::Vector3f& point) const {
    return !box_ || box_->contains(point.cast<double>());
  }

  const geometry::PointCloud& cloud() const { return cloud_; }
  geometry::PointCloud take() { return std::move(cloud_); }
  /// Returns the number of scans so far.
  std::uint32_t scans() const { return scans_; }

 private:
  std::optional<Eigen::AlignedBox3d> box_;
  geometry::SpacedPoints kept_;
  geometry::PointCloud cloud_;
  std::uint32_t scans_ = 0;
};

}  // namespace skycap::survey
