/// Settings of surveys without planning: a fixed set of views on a sphere (fixed_view_planner.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include <Eigen/Geometry>

#include "geometry/pose/pose.h"
#include "survey/view_limits.h"

namespace skycap::survey::fixed_views {

/// Distribution of the views over the sphere.
enum class ViewSet {
  fibonacci,  ///< Fibonacci lattice, equal areas
  rings,      ///< horizontal rings of equal area
  random,     ///< independent directions, uniform by area
};

/// Order in which the views are taken.
enum class ViewOrder {
  tour,    ///< short open tour from the first view
  spread,  ///< each view farthest from the earlier ones
};

/// Settings of a fixed set in a mission file.
struct FixedViewSettings {
  std::size_t views = 20;  ///< N: total number of views, including the first view of the survey
  ViewSet set = ViewSet::fibonacci;
  std::size_t rings = 1;  ///< number of rings of ViewSet::rings
  ViewOrder order = ViewOrder::tour;
};

struct FixedViewsConfig {
  FixedViewSettings settings;
  double spacing = 0.00261711877;                ///< minimum distance of stored points [m]
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are ignored
  ViewLimits limits;
  std::optional<Eigen::Vector3d> sphere_centre;  ///< set by the mission instead of the centroid [m]
  std::optional<double> sphere_radius;           ///< set by the mission [m]
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< centre of the sphere, world frame [m]
  double radius = 1.0;                               ///< radius of the sphere [m]
  std::uint64_t seed = 1;                            ///< seed of rotation and random directions
  /// Returns whether the true scene admits a view. Empty: all views within the limits.
  std::function<bool(const geometry::View&)> admits{};

  /// Throws Error{bad_config} that names the first field outside its interval.
  void validate() const;
};

}  // namespace skycap::survey::fixed_views
