/// Where on the sphere a large empty cap may be centred; for the sources of spherical_cap and their
/// tests only.
///
/// The faces of a cube, seen from its centre, are squares that cover the sphere. A square is given
/// up as soon as one member q of Q is so near to it that h >= s.q is too large for all of its s,
/// and cut into four otherwise, again and again. Where directions cover the sphere evenly, a look
/// at one or two members settles nearly every square.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/directions/direction_index.h"

namespace skycap::geometry {

/// The part of the unit sphere within `radius` of `centre`, as the crow flies.
struct SpherePart {
  Eigen::Vector3d centre;  ///< of unit length
  double radius;           ///< 2 for the whole sphere
};

struct Clearings {
  std::vector<SpherePart> parts;
  double cosine;  ///< h of some direction

  /// Whether some of the parts meets the cap of all s with s.normal >= cosine.
  bool meet(const Eigen::Vector3d& normal, double cosine) const;
};

/// Parts outside of which h is more than cap_tolerance above the cosine that is returned with them.
/// That is h of some direction if it is below `cosine`, which is h of some other, and otherwise
/// `cosine`. Where there are many such parts, one is returned, the whole sphere. O(n): 5 ms for
/// 100,000 random directions, at most 60 ms for as many of which all gaps are about the same.
Clearings find_clearings(DirectionIndex& occluded, double cosine);

}  // namespace skycap::geometry
