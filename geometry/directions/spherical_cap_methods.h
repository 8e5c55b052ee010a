/// The parts of clearest_direction(); for the sources of spherical_cap and their tests only.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/directions/direction_index.h"
#include "geometry/directions/spherical_cap.h"

namespace skycap::geometry {

/// Two cosines closer than this are the same, and an origin this near to the boundary of conv(Q) is
/// on it. Far above the rounding of the facets, far below what a sensor tells apart.
inline constexpr double cap_tolerance = 1e-6;

/// The three corners of a facet of conv(Q).
using Triangle = std::array<Eigen::Vector3d, 3>;

/// A normal of the facet, of any sign and length; zero if it is thinner than double precision
/// tells.
Eigen::Vector3d normal_of(const Triangle& facet);

/// How conv(Q) lies to the origin.
struct OriginInHull {
  Eigen::Vector3d nearest;                ///< point of conv(Q) nearest to the origin
  std::vector<Eigen::Vector3d> supports;  ///< at most 4 members of Q whose hull holds `nearest`
  bool is_inside;  ///< the origin lies deeper than cap_tolerance inside the hull of `supports`
};

/// Gilbert-Johnson-Keerthi: about ten queries of the index.
OriginInHull locate_origin(DirectionIndex& occluded);

/// The largest empty cap, where conv(Q) is a body and holds the origin within cap_tolerance.
/// `seeds` are members of Q that do not all lie in one plane. Ties are won by the direction nearest
/// to `known_clear`. Nothing is returned, and soon, if the cap's cosine is above `largest_cosine`.
std::optional<SphericalCap> largest_empty_cap(DirectionIndex& occluded,
                                              std::span<const Eigen::Vector3d> seeds,
                                              const Eigen::Vector3d& known_clear,
                                              double largest_cosine = 1.0);

/// A local minimum of h that is reached downhill from `known_clear`, where conv(Q) holds the origin
/// deeper than cap_tolerance.
SphericalCap local_empty_cap(DirectionIndex& occluded, const Eigen::Vector3d& known_clear);

/// The paper's nonlinear programs as its authors solve them.
std::optional<SphericalCap> cap_by_nonlinear_program(std::span<const Eigen::Vector3d> occluded,
                                                     const Eigen::Vector3d& known_clear,
                                                     int max_evaluations);

}  // namespace skycap::geometry
