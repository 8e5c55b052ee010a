/// Sets of views distributed over a sphere, and the order in which they are visited.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/pose.h"
#include "survey/fixed_views/fixed_views_config.h"

namespace skycap::survey::fixed_views {

/// Part of the unit sphere between two heights.
struct SphereBand {
  double min_z = -1.0;
  double max_z = 1.0;

  bool is_whole() const { return min_z <= -1.0 && max_z >= 1.0; }
};

/// Returns the band of a sphere that complies with the height and pitch limits for views of the
/// centre. Throws Error{bad_config} if no part of the sphere complies.
SphereBand compute_band(const ViewLimits& limits, const Eigen::Vector3d& centre, double radius);

/// Returns `count` unit vectors within the band. `rings` applies to ViewSet::rings. The set is
/// rotated at random: about the vertical, and on a whole sphere about all axes, except for rings.
std::vector<Eigen::Vector3d> make_directions(ViewSet set, std::size_t count, const SphereBand& band,
                                             std::size_t rings, std::uint64_t seed);

/// Returns up to settings.views - 1 views of the sphere's centre. A view that is not admissible is
/// moved outwards along its ray, in steps of a twentieth of the radius and up to twice the radius.
/// If that does not help, it is discarded and the number of directions raised. Fewer views result
/// only if 40 times as many directions are not enough.
std::vector<geometry::View> make_view_set(const FixedViewsConfig& config);

/// Returns the order of a short open tour that begins at `start` and visits all positions: nearest
/// neighbour, then 2-opt and or-opt (chains of up to three) to a local optimum.
std::vector<std::size_t> compute_tour(const Eigen::Vector3d& start,
                                      std::span<const Eigen::Vector3d> positions);

/// Returns the order in which each position has the maximum distance from all earlier ones and from
/// `start`. Ties: the lowest index.
std::vector<std::size_t> compute_spread(const Eigen::Vector3d& start,
                                        std::span<const Eigen::Vector3d> positions);

/// Returns the length of the open path from `start` through the positions in the given order.
double path_length(const Eigen::Vector3d& start, std::span<const Eigen::Vector3d> positions,
                   std::span<const std::size_t> order);

}  // namespace skycap::survey::fixed_views
