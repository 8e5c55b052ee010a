/// Which of a few hundred proposed views are nearest to a place.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace skycap::survey::see {

/// The indices of the `count` positions nearest to `query`, nearest first, equally near ones by
/// index; all if there are fewer.
std::vector<std::size_t> nearest_views(std::span<const Eigen::Vector3d> positions,
                                       const Eigen::Vector3d& query, std::size_t count);

/// The index of the position with the least distance from `query` plus `first_view_weight` times
/// that from `first_view`; of equal ones the nearer to `first_view`, then the lower index.
/// `positions` must not be empty.
std::size_t nearest_view(std::span<const Eigen::Vector3d> positions, const Eigen::Vector3d& query,
                         const Eigen::Vector3d& first_view, double first_view_weight);

/// What an approximate search in an octree of the positions gives: from the root down the child
/// whose centre is nearest to the query is entered, and the nearest position in the leaf so reached
/// is the answer. The octree is grown as the Point Cloud Library grows its own, by doubling towards
/// each position that is outside, leaves being of edge `leaf_size`. `positions` must not be empty.
std::size_t approximately_nearest_view(std::span<const Eigen::Vector3d> positions,
                                       const Eigen::Vector3d& query, double leaf_size);

}  // namespace skycap::survey::see
