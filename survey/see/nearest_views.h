/// Nearest-neighbour search among a few hundred proposed views.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace skycap::survey::see {

/// Returns the indices of the `count` positions nearest to `query`, or all if there are fewer. They
/// are sorted by distance, then by index.
std::vector<std::size_t> nearest_views(std::span<const Eigen::Vector3d> positions,
                                       const Eigen::Vector3d& query, std::size_t count);

/// Returns the index of the position that minimises distance to `query` + `first_view_weight` *
/// distance to `first_view`. Ties are resolved by the distance to `first_view`, then by index.
/// `positions` must not be empty.
std::size_t nearest_view(std::span<const Eigen::Vector3d> positions, const Eigen::Vector3d& query,
                         const Eigen::Vector3d& first_view, double first_view_weight);

/// Returns the result of an approximate nearest-neighbour search in an octree. The search descends
/// from the root to the child whose centre is nearest to the query. It returns the nearest position
/// in the leaf. The octree is built as in the Point Cloud Library, by doubling towards each outside
/// position; leaves have the edge length `leaf_size` [m]. `positions` must not be empty.
std::size_t approximately_nearest_view(std::span<const Eigen::Vector3d> positions,
                                       const Eigen::Vector3d& query, double leaf_size);

}  // namespace skycap::survey::see
