/// Where the pilot allows the sensor to be and which way it can look. World frame, z up.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/pose.h"
#include "geometry/place/prism.h"

namespace skycap::survey {

/// All limits hold at once; those not given do not limit. Heights are world z.
struct ViewLimits {
  std::optional<double> least_height;  ///< ground plus clearance
  std::optional<double> most_height;
  /// Simple polygon to stay inside of, its border included; empty: none.
  std::vector<Eigen::Vector2d> geofence;
  std::vector<geometry::Prism> no_fly;  ///< to stay outside of, their boundaries included
  double stand_off = 0.0;  ///< least distance from everything measured and from unknown space
  double least_pitch = -1.5707963267948966;  ///< of the viewing direction, down is negative [rad]
  double most_pitch = 1.5707963267948966;    ///< [rad]
  /// Least height over a place, where the ground is not level; must be safe to call from several
  /// threads. Null: least_height alone.
  std::function<double(const Eigen::Vector2d&)> least_height_over{};

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

 private:
  std::optional<geometry::View> turned_view(const Eigen::Vector3d& target,
                                            const Eigen::Vector3d& towards_view, double distance,
                                            const std::optional<double>& least) const;
};

}  // namespace skycap::survey
