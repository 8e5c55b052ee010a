/// Where a few points lie and which way they spread: the fit of a line or a plane.
#pragma once

#include <span>

#include <Eigen/Core>

namespace skycap::geometry {

/// Mean and principal axes of points; spreads ascend.
struct PrincipalAxes {
  Eigen::Vector3d mean;
  Eigen::Vector3d spreads;  ///< variances along the axes
  Eigen::Matrix3d axes;     ///< unit columns; the first is the normal of the plane that fits best
};

/// Of at least one point.
PrincipalAxes principal_axes(std::span<const Eigen::Vector3f> points);

}  // namespace skycap::geometry
