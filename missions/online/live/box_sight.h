/// Effects of a live survey's region of interest: the measurements outside the box, and the
/// fraction of the box's surface that was in no field of view.
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

/// Accumulates these figures over all scans of the survey. World frame [m].
class BoxSight {
 public:
  /// Samples the six faces of the box uniformly and reproducibly. Without a box, nothing is
  /// counted.
  BoxSight(const std::optional<Eigen::AlignedBox3d>& box, const geometry::CameraConfig& camera);

  /// Adds a scan in O(points + samples).
  void add(const geometry::Scan& scan);

  /// Returns the fraction of all measured points that are outside the box and therefore ignored; 0
  /// without points.
  double outside_share() const;

  /// Returns the fraction of the box's surface that was outside the field of view or range of every
  /// scan. Occlusion is not considered: surface behind a wall counts as seen. Returns nullopt
  /// without a box or a scan.
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
