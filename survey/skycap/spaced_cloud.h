/// The cloud that Skycap's own planner keeps: of all returns, those that are not too near to one
/// kept before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/place/camera.h"
#include "geometry/points/point_cloud.h"
#include "geometry/points/scan.h"
#include "geometry/points/spaced_points.h"

namespace skycap::survey::skycap {

class SpacedCloud {
 public:
  /// Points farther apart than `spacing` [m], of scans whose pixels are `pixel` apart on a wall.
  SpacedCloud(double spacing, double pixel);

  /// Keeps the returns within `region` that have room, said to come from scan number `view`;
  /// returns how many. An organised scan is of `camera`. What is kept does not depend on `threads`.
  std::size_t insert(const geometry::ScanSpan& scan, const geometry::Camera& camera,
                     const std::optional<Eigen::AlignedBox3f>& region, std::uint32_t view,
                     unsigned threads);

  /// Whether one of the first `count` points is within `radius` of a place.
  bool has_near(const Eigen::Vector3f& place, double radius, std::size_t count) const;

  const geometry::PointCloud& cloud() const { return cloud_; }
  /// Hands the points over; nothing may be asked afterwards.
  geometry::PointCloud release_cloud() { return std::move(cloud_); }

 private:
  geometry::SpacedPoints points_;
  geometry::PointCloud cloud_;
};

}  // namespace skycap::survey::skycap
