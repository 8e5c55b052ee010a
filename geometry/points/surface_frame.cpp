#include "geometry/points/surface_frame.h"

#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/points/principal_axes.h"
#include "geometry/pose/pose.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

/// Returns the unit vector orthogonal to `axis` that is nearest to `preferred`, or an arbitrary one
/// if both are parallel.
Vector3d across(const Vector3d& axis, const Vector3d& preferred) {
  const Vector3d rejected = preferred - preferred.dot(axis) * axis;
  return rejected.norm() > 1e-9 * preferred.norm() ? rejected.normalized() : any_orthogonal(axis);
}

/// Returns the frame with the given normal whose outward axis is nearest to `preferred_outward`.
SurfaceFrame make_frame(const Vector3d& normal, const Vector3d& preferred_outward) {
  const Vector3d outward = across(normal, preferred_outward);
  return {normal, outward, normal.cross(outward)};
}

}  // namespace

SurfaceFrame surface_frame(const Vector3d& point, std::span<const Eigen::Vector3f> neighbours,
                           const Vector3d& sensor) {
  const Vector3d to_sensor = (sensor - point).normalized();
  assert(to_sensor.allFinite());
  if (neighbours.size() < 3) return make_frame(to_sensor, Vector3d::Zero());

  // Rounding error of single-precision coordinates; spreads below it are zero.
  const double rounding = std::pow(1e-6 * (1.0 + point.cwiseAbs().maxCoeff()), 2);
  const auto [mean, spreads, axes] = principal_axes(neighbours);
  const Vector3d from_mean = point - mean;
  if (spreads[2] <= rounding) return make_frame(to_sensor, Vector3d::Zero());
  const double line_sign = from_mean.dot(axes.col(2)) < 0.0 ? -1.0 : 1.0;
  if (spreads[1] <= rounding) {
    return make_frame(across(axes.col(2), to_sensor), line_sign * axes.col(2));
  }

  const double normal_sign = axes.col(0).dot(to_sensor) < 0.0 ? -1.0 : 1.0;
  const Vector3d normal = normal_sign * axes.col(0);
  const double along_middle = from_mean.dot(axes.col(1));
  const double along_widest = from_mean.dot(axes.col(2));
  if (from_mean.squaredNorm() <= rounding) return make_frame(normal, axes.col(1));
  if (std::abs(along_widest) > std::abs(along_middle)) {
    return make_frame(normal, line_sign * axes.col(2));
  }
  return make_frame(normal, (along_middle < 0.0 ? -1.0 : 1.0) * axes.col(1));
}

}  // namespace skycap::geometry
