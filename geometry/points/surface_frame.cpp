#include "geometry/points/surface_frame.h"

#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/place/pose.h"
#include "geometry/points/principal_axes.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

/// Returns the unit vector orthogonal to `axis` that is nearest to `wanted`, or an arbitrary one if
/// both are parallel.
Vector3d across(const Vector3d& axis, const Vector3d& wanted) {
  const Vector3d rejected = wanted - wanted.dot(axis) * axis;
  return rejected.norm() > 1e-9 * wanted.norm() ? rejected.normalized() : any_orthogonal(axis);
}

/// Returns the frame with the given normal whose outward axis is nearest to `wanted_outward`.
SurfaceFrame frame_of(const Vector3d& normal, const Vector3d& wanted_outward) {
  const Vector3d outward = across(normal, wanted_outward);
  return {normal, outward, normal.cross(outward)};
}

}  // namespace

SurfaceFrame surface_frame(const Vector3d& point, std::span<const Eigen::Vector3f> neighbours,
                           const Vector3d& sensor) {
  const Vector3d to_sensor = (sensor - point).normalized();
  assert(to_sensor.allFinite());
  if (neighbours.size() < 3) return frame_of(to_sensor, Vector3d::Zero());

  // Rounding error of single-precision coordinates; spreads below it are zero.
  const double rounding = std::pow(1e-6 * (1.0 + point.cwiseAbs().maxCoeff()), 2);
  const auto [mean, spreads, axes] = principal_axes(neighbours);
  const Vector3d from_mean = point - mean;
  if (spreads[2] <= rounding) return frame_of(to_sensor, Vector3d::Zero());
  const double sign_of_line = from_mean.dot(axes.col(2)) < 0.0 ? -1.0 : 1.0;
  if (spreads[1] <= rounding) {
    return frame_of(across(axes.col(2), to_sensor), sign_of_line * axes.col(2));
  }

  const double sign_of_normal = axes.col(0).dot(to_sensor) < 0.0 ? -1.0 : 1.0;
  const Vector3d normal = sign_of_normal * axes.col(0);
  const double along_middle = from_mean.dot(axes.col(1));
  const double along_widest = from_mean.dot(axes.col(2));
  if (from_mean.squaredNorm() <= rounding) return frame_of(normal, axes.col(1));
  if (std::abs(along_widest) > std::abs(along_middle)) {
    return frame_of(normal, sign_of_line * axes.col(2));
  }
  return frame_of(normal, (along_middle < 0.0 ? -1.0 : 1.0) * axes.col(1));
}

}  // namespace skycap::geometry
