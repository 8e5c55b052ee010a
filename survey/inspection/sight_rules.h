/// Camera of an inspection, and the rules by which a point of a structure counts as seen.
///
/// Rule A (pixel): inside the image, in range, and the nearest point of the cloud in its pixel.
/// Rule B (solid): inside the image, in range, and not hidden by the discs of the cloud.
/// Rule C (incidence): rule B, at a limited angle of incidence.
///
/// The planner replaces rule A by "inside the image and in range", which is almost the same:
/// between the points of a wall, the pixels show the points behind it. Only rules B and C tell
/// whether a surface is seen.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "geometry/angle.h"

namespace skycap::survey::inspection {

/// Number of rules of visibility, and their indices.
inline constexpr std::size_t sight_rules = 3;
inline constexpr std::size_t pixel_rule = 0, solid_rule = 1, incidence_rule = 2;
/// Value for each rule.
template <typename Value>
using PerRule = std::array<Value, sight_rules>;

struct InspectionCamera {
  double horizontal_fov = 75.0 * geometry::radians_per_degree;  ///< Full angle [rad].
  double vertical_fov = 55.0 * geometry::radians_per_degree;    ///< Full angle [rad].
  double range = 8.0;                                           ///< Maximum distance [m].
  double max_incidence = 75.0 * geometry::radians_per_degree;   ///< Rule C [rad].
  int width = 640;                                              ///< Pixels of rule A.
  int height = 480;

  /// Throws Error{bad_config} naming the first value outside its interval.
  void validate() const;
};

/// Camera axes for yaw and pitch, without roll. `left` is horizontal.
struct CameraAxes {
  CameraAxes(double yaw, double pitch)
      : forward(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), std::sin(pitch)),
        left(-std::sin(yaw), std::cos(yaw), 0.0),
        up(-std::cos(yaw) * std::sin(pitch), -std::sin(yaw) * std::sin(pitch), std::cos(pitch)) {}
  Eigen::Vector3d forward, left, up;
};

}  // namespace skycap::survey::inspection
