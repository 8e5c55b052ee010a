/// Which views see which frontiers, and the view that sees most for the way (SEE++ §III-C).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

namespace skycap::survey::see {

/// A directed graph over frontier-view pairs, each named by its frontier's point: an edge from j to
/// k says that the view proposed for j sees the frontier k.
class VisibilityGraph {
 public:
  /// Replaces the outgoing edges of `from`; none may lead to itself.
  void set_edges(std::uint32_t from, std::vector<std::uint32_t> to);
  /// Drops every vertex that is not in `vertices` (ascending), and the edges to it.
  void keep_only(const std::vector<std::uint32_t>& vertices);

  /// deg+: how many other frontiers a view sees.
  std::size_t out_degree(std::uint32_t vertex) const;
  bool has_edge(std::uint32_t from, std::uint32_t to) const;

 private:
  std::map<std::uint32_t, std::vector<std::uint32_t>> edges_;  // ascending
};

/// The view to take next: of those that see the frontier whose proposal is nearest to the sensor,
/// and more frontiers than that proposal does, the one with the most frontiers a metre of way; the
/// nearest proposal itself if there is none. `vertices` (ascending, not empty) have their views at
/// `positions`; `nearest` is the place in both lists of the proposal nearest to `sensor`. Returns a
/// place in the lists. Ties go to the shorter way, then to the lower vertex.
std::size_t select_by_coverage(const VisibilityGraph& graph,
                               const std::vector<std::uint32_t>& vertices,
                               const std::vector<Eigen::Vector3d>& positions, std::size_t nearest,
                               const Eigen::Vector3d& sensor);

}  // namespace skycap::survey::see
