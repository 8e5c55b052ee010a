/// What the region of interest of a live survey keeps from being surveyed: measurements outside of
/// it, and the part of its surface that was never in view.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"

namespace skycap::missions::online {

/// Keeps count over all scans that were used. World frame, metres.
class BoxSight {
 public:
  /// Samples the six faces of the box, evenly and the same each time. Without a box nothing is
  /// counted.
  BoxSight(const std::optional<Eigen::AlignedBox3d>& box, const geometry::CameraConfig& camera);

  /// O(points and samples).
  void add(const geometry::Scan& scan);

  /// Share of all measured points that are outside of the box and therefore ignored; 0 without
  /// points.
  double outside_share() const;

  /// Share of the box's surface that was in the field of view and range of no scan. Occlusion is
  /// not considered: what is behind a wall counts as seen. Nothing without a box or a scan.
  std::optional<double> unseen_share() const;

 private:
  std::optional<Eigen::AlignedBox3d> box_;
  geometry::Camera camera_;
  std::vector<Eigen::Vector3d> samples_;
  std::vector<double> areas_;  ///< of the box's surface, for each sample [m^2]
  std::vector<std::uint8_t> is_seen_;
  std::size_t points_ = 0, outside_ = 0, scans_ = 0;
};

}  // namespace skycap::missions::online
