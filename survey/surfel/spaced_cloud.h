/// Cloud of Skycap's own planner: all returns, downsampled to a minimum spacing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/point_cloud.h"
#include "geometry/points/scan.h"
#include "geometry/points/spaced_points.h"
#include "geometry/pose/camera.h"

namespace skycap::survey::surfel {

class SpacedCloud {
 public:
  /// `spacing` is the minimum distance of points [m]. `pixel` is the pixel spacing of the scans on
  /// a wall [m].
  SpacedCloud(double spacing, double pixel);

  /// Inserts the returns within `region` that are far enough from all kept points and attributes
  /// them to scan `view`. Returns their number. An organised scan must be an image of `camera`. The
  /// result does not depend on `threads`.
  std::size_t insert(const geometry::ScanSpan& scan, const geometry::Camera& camera,
                     const std::optional<Eigen::AlignedBox3f>& region, std::uint32_t view,
                     unsigned threads);

  /// Returns whether one of the first `count` points is within `radius` of `position`.
  bool has_near(const Eigen::Vector3f& position, double radius, std::size_t count) const;

  const geometry::PointCloud& cloud() const { return cloud_; }
  /// Moves the cloud out. No other member function may be called afterwards.
  geometry::PointCloud take_cloud() { return std::move(cloud_); }

 private:
  geometry::SpacedPoints points_;
  geometry::PointCloud cloud_;
};

}  // namespace skycap::survey::surfel
