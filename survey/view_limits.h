/// Limits of the sensor's position and direction, set by the pilot. World frame, z up.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/pose.h"
#include "geometry/pose/prism.h"

namespace skycap::survey {

/// All limits apply at the same time. Unset limits have no effect. Heights are world z [m].
struct ViewLimits {
  std::optional<double> min_height;  ///< ground plus clearance
  std::optional<double> max_height;
  /// Simple polygon that contains all views, border included; empty: no geofence.
  std::vector<Eigen::Vector2d> geofence;
  std::vector<geometry::Prism> no_fly;  ///< volumes that exclude all views, boundary included
  double min_standoff =
      0.0;  ///< minimum distance from all measured points and from unknown space [m]
  double min_pitch = -1.5707963267948966;  ///< pitch of the view direction, negative is down [rad]
  double max_pitch = 1.5707963267948966;   ///< [rad]
  /// Returns the minimum height above a position on uneven ground. Must be thread-safe. Null:
  /// min_height applies everywhere.
  std::function<double(const Eigen::Vector2d&)> min_height_at{};

  /// Throws Error{bad_config} that names the first invalid field.
  void validate() const;

  /// Returns whether the view complies with all limits except the stand-off, which requires a map.
  bool allow(const geometry::View& view) const;

  /// Returns the view of `target` from `distance` in the direction of the unit vector
  /// `towards_view`. The view is rotated vertically about the target by the minimum angle that the
  /// height and pitch limits require. Returns nullopt if no such view complies with all limits.
  std::optional<geometry::View> make_target_view(const Eigen::Vector3d& target,
                                                 const Eigen::Vector3d& towards_view,
                                                 double distance) const;

 private:
  std::optional<geometry::View> turned_view(const Eigen::Vector3d& target,
                                            const Eigen::Vector3d& towards_view, double distance,
                                            const std::optional<double>& min) const;
};

}  // namespace skycap::survey
