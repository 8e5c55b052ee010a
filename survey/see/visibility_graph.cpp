#include "survey/see/visibility_graph.h"

#include <algorithm>
#include <cassert>

namespace skycap::survey::see {

void VisibilityGraph::set_edges(std::uint32_t from, std::vector<std::uint32_t> to) {
  std::sort(to.begin(), to.end());
  assert(!std::binary_search(to.begin(), to.end(), from));
  edges_[from] = std::move(to);
}

void VisibilityGraph::keep_only(const std::vector<std::uint32_t>& vertices) {
  const auto is_gone = [&](std::uint32_t vertex) {
    return !std::binary_search(vertices.begin(), vertices.end(), vertex);
  };
  std::erase_if(edges_, [&](const auto& entry) { return is_gone(entry.first); });
  for (auto& [from, to] : edges_) std::erase_if(to, is_gone);
}

std::size_t VisibilityGraph::out_degree(std::uint32_t vertex) const {
  const auto found = edges_.find(vertex);
  return found == edges_.end() ? 0 : found->second.size();
}

bool VisibilityGraph::has_edge(std::uint32_t from, std::uint32_t to) const {
  const auto found = edges_.find(from);
  return found != edges_.end() &&
         std::binary_search(found->second.begin(), found->second.end(), to);
}

std::size_t select_by_coverage(const VisibilityGraph& graph,
                               const std::vector<std::uint32_t>& vertices,
                               const std::vector<Eigen::Vector3d>& positions, std::size_t nearest,
                               const Eigen::Vector3d& sensor) {
  constexpr double min_distance =
      1e-3;  // minimum path length; avoids division by zero at the sensor position
  const std::size_t nearest_degree = graph.out_degree(vertices[nearest]);
  std::size_t best = nearest;
  double best_ratio = -1.0, best_distance = 0.0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::size_t degree = graph.out_degree(vertices[i]);
    if (degree <= nearest_degree || !graph.has_edge(vertices[i], vertices[nearest])) continue;
    const double distance = (positions[i] - sensor).norm();
    const double ratio = static_cast<double>(degree) / std::max(distance, min_distance);
    if (ratio > best_ratio || (ratio == best_ratio && distance < best_distance)) {
      best = i;
      best_ratio = ratio;
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace skycap::survey::see
