/// Mean and principal axes of a few points, for fitting a line or a plane.
#pragma once

#include <span>

#include <Eigen/Core>

namespace skycap::geometry {

/// Mean and principal axes of points, by ascending variance.
struct PrincipalAxes {
  Eigen::Vector3d mean;
  Eigen::Vector3d spreads;  ///< variances along the axes [m^2]
  Eigen::Matrix3d axes;     ///< unit columns; the first is the normal of the best-fitting plane
};

/// Requires at least one point.
PrincipalAxes principal_axes(std::span<const Eigen::Vector3f> points);

}  // namespace skycap::geometry
