/// Where the pilot allows the sensor to be and which way it can look. World frame, z up.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/pose.h"

namespace skycap::survey {

/// A vertical prism over a simple polygon, such as a no-fly volume.
struct Prism {
  std::vector<Eigen::Vector2d> corners;  ///< east and north, in either sense, three or more
  double bottom = 0.0;                   ///< lowest z
  double top = 0.0;                      ///< highest z

  bool contains(const Eigen::Vector3d& point) const;
};

/// The prism over an axis-aligned box.
Prism box_prism(const Eigen::Vector3d& lowest, const Eigen::Vector3d& highest);

/// All limits hold at once; those not given do not limit. Heights are world z.
struct ViewLimits {
  std::optional<double> least_height;  ///< ground plus clearance
  std::optional<double> most_height;
  std::vector<Eigen::Vector2d> geofence;  ///< polygon to stay inside of; empty: none
  std::vector<Prism> no_fly;              ///< to stay outside of
  double stand_off = 0.0;  ///< least distance from everything measured and from unknown space
  double least_pitch = -1.5707963267948966;  ///< of the viewing direction, down is negative [rad]
  double most_pitch = 1.5707963267948966;    ///< [rad]

  /// Throws Error{bad_config} naming the first field that is not usable.
  void validate() const;

  /// Whether the view obeys every limit but the stand-off, which needs a map.
  bool allow(const geometry::View& view) const;

  /// The view of `target` from `distance` in the direction `towards_view` (unit), turned up or down
  /// about the target as little as height and pitch limits need; nothing if they leave no view at
  /// that distance and azimuth, or if it breaks another limit.
  std::optional<geometry::View> view_of_target(const Eigen::Vector3d& target,
                                               const Eigen::Vector3d& towards_view,
                                               double distance) const;
};

}  // namespace skycap::survey
