#include "geometry/spherical_cap/spherical_cap.h"

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/error.h"
#include "geometry/pose/pose.h"
#include "geometry/spherical_cap/spherical_cap_methods.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

// Returns the normalised component of `direction` orthogonal to the unit vector `axis`, or an
// arbitrary orthogonal vector if the component is zero.
Vector3d orthogonal_part(const Vector3d& direction, const Vector3d& axis) {
  const Vector3d part = direction - direction.dot(axis) * axis;
  return part.norm() > cap_tolerance ? Vector3d(part.normalized()) : any_orthogonal(axis);
}

Vector3d farthest_from_line(std::span<const Vector3d> directions, const Vector3d& axis) {
  Vector3d farthest = directions.front();
  double largest = -1.0;
  for (const Vector3d& q : directions) {
    const double distance = q.cross(axis).squaredNorm();
    if (distance > largest) largest = distance, farthest = q;
  }
  return farthest;
}

// Handles an origin on the boundary of conv(Q), or a search that ended on an inner face: an
// antipodal pair, a great circle, a hemisphere, or a symmetric body. Returns nullopt for a body
// that contains the origin. `seeds` are then members that are not coplanar.
std::optional<SphericalCap> cap_at_right_angles(std::span<const Vector3d> occluded,
                                                DirectionIndex& index, const Vector3d& known_clear,
                                                std::vector<Vector3d>& seeds) {
  const Vector3d& a = occluded.front();
  const Vector3d b = farthest_from_line(occluded, a);
  if (a.cross(b).norm() <= cap_tolerance) {
    const Vector3d direction = orthogonal_part(known_clear, a);
    return SphericalCap{direction, index.nearest(direction).cosine};
  }
  Vector3d pole = a.cross(b).normalized();
  if (pole.dot(known_clear) < 0.0) pole = -pole;
  const auto above = index.nearest(pole), below = index.nearest(-pole);
  if (above.cosine <= cap_tolerance && below.cosine <= cap_tolerance) {
    return SphericalCap{pole, above.cosine};
  }
  seeds.insert(seeds.end(), {a, b, above.direction, below.direction});
  return largest_empty_cap(index, seeds, known_clear, cap_tolerance);
}

std::optional<SphericalCap> exact_cap(std::span<const Vector3d> occluded,
                                      const Vector3d& known_clear, CapPolicy policy) {
  if (occluded.empty()) return SphericalCap{known_clear, -1.0};
  DirectionIndex index(occluded);
  OriginInHull origin = locate_origin(index);
  const double distance = origin.nearest.norm();
  if (distance > cap_tolerance) {
    const Vector3d direction = -origin.nearest / distance;
    return SphericalCap{direction, index.nearest(direction).cosine};
  }
  if (!origin.is_inside) {
    if (auto cap = cap_at_right_angles(occluded, index, known_clear, origin.supports)) {
      return cap;
    }
  }
  return policy == CapPolicy::global ? largest_empty_cap(index, origin.supports, known_clear)
                                     : local_empty_cap(index, known_clear);
}

}  // namespace

void CapConfig::validate() const {
  if (max_evaluations < 1) {
    throw Error(ErrorKind::bad_config, "max_evaluations is " + std::to_string(max_evaluations) +
                                           "; it must be at least 1");
  }
}

std::optional<SphericalCap> clearest_direction(std::span<const Vector3d> occluded,
                                               const Vector3d& known_clear,
                                               const CapConfig& config) {
  if (config.policy == CapPolicy::nonlinear_program) {
    return cap_by_nonlinear_program(occluded, known_clear, config.max_evaluations);
  }
  return exact_cap(occluded, known_clear, config.policy);
}

}  // namespace skycap::geometry
