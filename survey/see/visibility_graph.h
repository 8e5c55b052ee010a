/// Visibility of frontiers from views, and selection of the view with the largest coverage per path
/// length (SEE++ §III-C).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

namespace skycap::survey::see {

/// Directed graph whose vertices are frontier-view pairs, identified by the frontier's point. An
/// edge from j to k means that the view proposed for j sees frontier k.
class VisibilityGraph {
 public:
  /// Replaces the outgoing edges of `from`. Loops are not allowed.
  void set_edges(std::uint32_t from, std::vector<std::uint32_t> to);
  /// Removes all vertices that are not in `vertices` (ascending) and their edges.
  void keep_only(const std::vector<std::uint32_t>& vertices);

  /// Returns deg+: the number of other frontiers that a view sees.
  std::size_t out_degree(std::uint32_t vertex) const;
  bool has_edge(std::uint32_t from, std::uint32_t to) const;

 private:
  std::map<std::uint32_t, std::vector<std::uint32_t>>
      edges_;  // outgoing edges by vertex, ascending
};

/// Returns the index of the next view in `vertices`. The candidates see the frontier of the nearest
/// proposal and more frontiers than that proposal does. The candidate with the most frontiers per
/// metre of path wins. Without candidates, the nearest proposal is returned. Ties are resolved by
/// the shorter path, then by the lower vertex.
///
/// `vertices` must be ascending and not empty, and `positions` contains their view positions.
/// `nearest` is the index of the proposal nearest to `sensor`.
std::size_t select_by_coverage(const VisibilityGraph& graph,
                               const std::vector<std::uint32_t>& vertices,
                               const std::vector<Eigen::Vector3d>& positions, std::size_t nearest,
                               const Eigen::Vector3d& sensor);

}  // namespace skycap::survey::see
