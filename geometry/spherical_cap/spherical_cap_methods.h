/// Steps of clearest_direction(). Only for the sources of spherical_cap and their tests.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/spherical_cap/direction_index.h"
#include "geometry/spherical_cap/spherical_cap.h"

namespace skycap::geometry {

/// Tolerance below which two cosines are considered equal and an origin is considered to be on the
/// boundary of conv(Q). It is far above the rounding error of the facets and far below the angular
/// resolution of sensors.
inline constexpr double cap_tolerance = 1e-6;

/// Corners of a facet of conv(Q).
using Triangle = std::array<Eigen::Vector3d, 3>;

/// Returns a normal of the facet with arbitrary sign and length, or zero if the facet is too thin
/// for double precision.
Eigen::Vector3d compute_normal(const Triangle& facet);

/// Position of the origin relative to conv(Q).
struct OriginInHull {
  Eigen::Vector3d nearest;                ///< point of conv(Q) nearest to the origin
  std::vector<Eigen::Vector3d> supports;  ///< at most 4 members of Q whose hull contains `nearest`
  bool
      is_inside;  ///< true if the origin is deeper than cap_tolerance inside the hull of `supports`
};

/// Locates the origin with the Gilbert-Johnson-Keerthi algorithm. Needs about ten queries of the
/// index.
OriginInHull locate_origin(DirectionIndex& occluded);

/// Returns the largest empty cap. Requires that conv(Q) has a volume and contains the origin within
/// cap_tolerance. `seeds` are members of Q that are not coplanar. Among equal caps, the direction
/// nearest to `known_clear` is returned. Returns nullopt early if the cosine of the cap exceeds
/// `largest_cosine`.
std::optional<SphericalCap> largest_empty_cap(DirectionIndex& occluded,
                                              std::span<const Eigen::Vector3d> seeds,
                                              const Eigen::Vector3d& known_clear,
                                              double largest_cosine = 1.0);

/// Returns the local minimum of h that a descent from `known_clear` reaches. Requires that the
/// origin is deeper than cap_tolerance inside conv(Q).
SphericalCap local_empty_cap(DirectionIndex& occluded, const Eigen::Vector3d& known_clear);

/// Solves the nonlinear programs of the paper in the same way as the authors' code.
std::optional<SphericalCap> cap_by_nonlinear_program(std::span<const Eigen::Vector3d> occluded,
                                                     const Eigen::Vector3d& known_clear,
                                                     int max_evaluations);

}  // namespace skycap::geometry
