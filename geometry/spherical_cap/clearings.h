/// Branch-and-bound search for the regions of the unit sphere that can contain the centre of a
/// large empty cap. Only for the sources of spherical_cap and their tests.
///
/// The faces of a cube, seen from its centre, are squares that cover the sphere. A square is
/// discarded as soon as one member q of Q proves that h >= s.q is too large for all its s.
/// Otherwise it is divided into four squares, recursively. If the directions cover the sphere
/// evenly, one or two members decide nearly every square.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/spherical_cap/direction_index.h"

namespace skycap::geometry {

/// Part of the unit sphere within the Euclidean distance `radius` of `centre`.
struct SpherePart {
  Eigen::Vector3d centre;  ///< unit vector
  double radius;           ///< chord length; 2 covers the whole sphere
};

struct Clearings {
  std::vector<SpherePart> parts;
  double cosine;  ///< value of h in some direction

  /// Returns whether at least one part intersects the cap of all s with s.normal >= cosine.
  bool meet(const Eigen::Vector3d& normal, double cosine) const;
};

/// Returns parts such that h exceeds the returned cosine by more than cap_tolerance everywhere
/// outside them. `cosine` is the value of h in some direction. The returned cosine is a smaller
/// value of h if the search finds one, otherwise `cosine`. If there are too many parts, a single
/// part that covers the whole sphere is returned. Complexity: O(n). 100,000 random directions take
/// 5 ms, or at most 60 ms if all gaps have about the same size.
Clearings find_clearings(DirectionIndex& occluded, double cosine);

}  // namespace skycap::geometry
