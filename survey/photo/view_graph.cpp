#include "survey/photo/view_graph.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "geometry/parallel.h"

namespace skycap::survey::photo {
namespace {

using Eigen::Vector3f;

/// Set of samples with one bit each.
using Bits = std::vector<std::uint64_t>;

Bits to_bits(std::span<const std::uint32_t> observed, std::size_t samples) {
  Bits bits((samples + 63) / 64, 0);
  for (const std::uint32_t s : observed) bits[s / 64] |= std::uint64_t{1} << (s % 64);
  return bits;
}

std::size_t count_shared(const Bits& a, const Bits& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    count += static_cast<std::size_t>(std::popcount(a[i] & b[i]));
  return count;
}

/// Photo with its observed samples.
struct PhotoNode {
  const geometry::View* view;
  std::span<const std::uint32_t> observed;
  Bits bits;
};

std::vector<PhotoNode> make_nodes(std::span<const geometry::View> photos,
                                  const IndexLists& observed, std::size_t samples,
                                  unsigned threads) {
  std::vector<PhotoNode> nodes(photos.size());
  geometry::parallel_for(photos.size(), threads, [&](std::size_t i) {
    nodes[i] = {&photos[i], observed[i], to_bits(observed[i], samples)};
  });
  return nodes;
}

/// Returns the samples that can be matched as a fraction of the smaller set of samples. Returns 0
/// for a fraction below `min_matchable`.
double matchable_share(const PhotoNode& a, const PhotoNode& b, const TargetSamples& samples,
                       const EdgeRule& rule, double min_matchable) {
  const std::size_t smaller = std::min(a.observed.size(), b.observed.size());
  const double wanted = min_matchable * static_cast<double>(smaller);
  if (smaller == 0 || static_cast<double>(count_shared(a.bits, b.bits)) < wanted) return 0.0;
  const auto max_scale = static_cast<float>(rule.max_scale);
  std::size_t count = 0;
  for (const std::uint32_t s : a.observed) {
    if ((b.bits[s / 64] >> (s % 64) & 1U) == 0) continue;
    const Observation in_a = make_observation(a.view->position, 0, samples, s);
    const Observation in_b = make_observation(b.view->position, 1, samples, s);
    const float nearer = std::min(in_a.distance, in_b.distance);
    const float farther = std::max(in_a.distance, in_b.distance);
    if (farther <= max_scale * nearer && transition_tilt(in_a, in_b) <= rule.max_tilt) ++count;
  }
  return static_cast<double>(count) >= wanted
             ? static_cast<double>(count) / static_cast<double>(smaller)
             : 0.0;
}

/// Disjoint sets: union-find with the lowest member as root.
class Parts {
 public:
  explicit Parts(std::size_t count) : root_(count) { std::iota(root_.begin(), root_.end(), 0U); }
  std::uint32_t root(std::uint32_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t ra = root(a), rb = root(b);
    root_[std::max(ra, rb)] = std::min(ra, rb);
  }
  std::uint32_t add() {
    root_.push_back(static_cast<std::uint32_t>(root_.size()));
    return root_.back();
  }

 private:
  std::vector<std::uint32_t> root_;
};

using Neighbours = std::vector<std::vector<std::uint32_t>>;

/// Number of edges to registered photos that an incremental registration of a photo needs. With one
/// edge, the photo shares no points with two registered photos, so that no point is triangulated.
constexpr std::uint32_t edges_to_register = 2;

/// Returns for each photo whether a registration that starts with this edge reaches it.
std::vector<char> register_from(const Neighbours& neighbours, std::uint32_t first,
                                std::uint32_t second) {
  std::vector<char> is_registered(neighbours.size(), 0);
  std::vector<std::uint32_t> edges(neighbours.size(), 0), queue{first, second};
  is_registered[first] = is_registered[second] = 1;
  while (!queue.empty()) {
    const std::uint32_t photo = queue.back();
    queue.pop_back();
    for (const std::uint32_t other : neighbours[photo]) {
      if (++edges[other] < edges_to_register || is_registered[other] != 0) continue;
      is_registered[other] = 1;
      queue.push_back(other);
    }
  }
  return is_registered;
}

/// Returns the largest registration over all edges, the first one of several. Edges inside a
/// registration are not tried again.
std::vector<char> largest_registration(const Neighbours& neighbours) {
  std::vector<std::vector<char>> all;
  std::vector<char> largest(neighbours.size(), 0);
  std::ptrdiff_t most = 0;
  for (std::uint32_t i = 0; i < neighbours.size(); ++i) {
    for (const std::uint32_t j : neighbours[i]) {
      const bool is_known = std::ranges::any_of(
          all, [&](const std::vector<char>& set) { return set[i] != 0 && set[j] != 0; });
      if (j < i || is_known) continue;
      all.push_back(register_from(neighbours, i, j));
      const std::ptrdiff_t count = std::ranges::count(all.back(), 1);
      if (count > most) most = count, largest = all.back();
    }
  }
  return largest;
}

Neighbours make_neighbours(const ViewGraph& graph) {
  Neighbours neighbours(graph.photos);
  for (const PhotoPair& edge : graph.edges) {
    neighbours[edge.first].push_back(edge.second);
    neighbours[edge.second].push_back(edge.first);
  }
  return neighbours;
}

}  // namespace

double transition_tilt(const Observation& a, const Observation& b) {
  // In the plane, u = ray - cosine normal. A photo maps the metric of the plane to I - u u^T, up to
  // its scale. The squares of the singular values of the map from image a to image b are the
  // eigenvalues of (I - u_a u_a^T)^-1 (I - u_b u_b^T).
  const double a_squared = double{a.cosine} * a.cosine, b_squared = double{b.cosine} * b.cosine;
  const double product = double{a.ray.dot(b.ray)} - double{a.cosine} * b.cosine;
  const double trace = 1.0 + b_squared + (1.0 - a_squared - product * product) / a_squared;
  const double determinant = b_squared / a_squared;
  const double root = std::sqrt(std::max(0.0, 0.25 * trace * trace - determinant));
  return std::max(1.0, (0.5 * trace + root) / std::sqrt(determinant));
}

std::vector<PhotoPair> matchable_pairs(std::span<const geometry::View> photos,
                                       const IndexLists& observed, const TargetSamples& samples,
                                       const EdgeRule& rule, double min_matchable,
                                       unsigned threads) {
  const std::vector<PhotoNode> nodes = make_nodes(photos, observed, samples.size(), threads);
  std::vector<std::vector<PhotoPair>> of_first(photos.size());
  geometry::parallel_for(photos.size(), threads, [&](std::size_t i) {
    for (std::size_t j = i + 1; j < photos.size(); ++j) {
      const double share = matchable_share(nodes[i], nodes[j], samples, rule, min_matchable);
      if (share == 0.0) continue;
      of_first[i].push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), share});
    }
  });
  std::vector<PhotoPair> pairs;
  for (const auto& some : of_first) pairs.insert(pairs.end(), some.begin(), some.end());
  return pairs;
}

std::size_t ViewGraph::min_degree() const {
  return degree.empty() ? 0 : *std::ranges::min_element(degree);
}

ViewGraph view_graph(std::span<const geometry::View> photos, const IndexLists& observed,
                     const TargetSamples& samples, const EdgeRule& rule, unsigned threads) {
  ViewGraph graph;
  graph.photos = photos.size();
  graph.degree.assign(photos.size(), 0);
  Parts parts(photos.size());
  for (const PhotoPair& pair :
       matchable_pairs(photos, observed, samples, rule, rule.min_matchable, threads)) {
    graph.edges.push_back(pair);
    ++graph.degree[pair.first];
    ++graph.degree[pair.second];
    parts.join(pair.first, pair.second);
  }
  std::vector<std::uint32_t> roots;
  for (std::uint32_t i = 0; i < photos.size(); ++i) {
    const std::uint32_t root = parts.root(i);
    const auto known = std::ranges::find(roots, root);
    graph.part.push_back(static_cast<std::uint32_t>(known - roots.begin()));
    if (known == roots.end()) roots.push_back(root), graph.parts.push_back(0);
    ++graph.parts[graph.part.back()];
  }
  std::ranges::sort(graph.parts, std::greater());
  graph.is_registered = largest_registration(make_neighbours(graph));
  graph.registered = static_cast<std::size_t>(std::ranges::count(graph.is_registered, 1));
  return graph;
}

std::vector<std::uint32_t> connecting_photos(std::span<const geometry::View> photos,
                                             const IndexLists& observed,
                                             std::span<const geometry::View> candidates,
                                             const IndexLists& observed_by_candidates,
                                             const TargetSamples& samples, const EdgeRule& rule,
                                             std::size_t degree_wanted, double same_position,
                                             std::size_t max_photos, unsigned threads) {
  const ViewGraph graph = view_graph(photos, observed, samples, rule, threads);
  Parts parts(photos.size());
  std::vector<std::uint32_t> degree = graph.degree;
  for (const PhotoPair& edge : graph.edges) parts.join(edge.first, edge.second);
  Neighbours neighbours = make_neighbours(graph);

  const std::vector<PhotoNode> own = make_nodes(photos, observed, samples.size(), threads);
  const std::vector<PhotoNode> others =
      make_nodes(candidates, observed_by_candidates, samples.size(), threads);
  std::vector<char> is_open(candidates.size(), 1);
  std::vector<std::vector<std::uint32_t>> edges(
      candidates.size());  // Edges to photos and added candidates.
  const auto close_near = [&](const Eigen::Vector3d& position) {
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      if ((candidates[c].position - position).norm() < same_position) is_open[c] = 0;
    }
  };
  const auto connects = [&](const PhotoNode& a, const PhotoNode& b) {
    return matchable_share(a, b, samples, rule, rule.min_matchable) > 0.0;
  };
  for (const geometry::View& photo : photos) close_near(photo.position);
  geometry::parallel_for(candidates.size(), threads, [&](std::size_t c) {
    if (is_open[c] == 0) return;
    for (std::uint32_t i = 0; i < own.size(); ++i) {
      if (connects(own[i], others[c])) edges[c].push_back(i);
    }
  });

  const auto is_done = [&] {
    std::set<std::uint32_t> roots;
    for (std::uint32_t i = 0; i < degree.size(); ++i) roots.insert(parts.root(i));
    return roots.size() <= 1 &&
           std::ranges::all_of(degree, [&](std::uint32_t d) { return d >= degree_wanted; });
  };
  // If no single photo joins two parts, add the one closest to another part.
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<Eigen::Vector3d> positions;  // Positions of photos and added candidates.
  for (const geometry::View& photo : photos) positions.push_back(photo.position);
  const auto distance_to_others = [&](const Eigen::Vector3d& position, std::uint32_t part) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
      if (parts.root(i) != part) nearest = std::min(nearest, (positions[i] - position).norm());
    }
    return nearest;
  };
  const auto step_towards_another_part = [&] {
    std::uint32_t choice = none;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t c = 0; c < candidates.size(); ++c) {
      if (is_open[c] == 0 || edges[c].empty()) continue;
      const std::uint32_t part = parts.root(edges[c].front());
      const double distance = distance_to_others(candidates[c].position, part);
      // A candidate must be closer to another part than the photo to which it registers.
      if (distance < nearest && distance < distance_to_others(positions[edges[c].front()], part)) {
        nearest = distance;
        choice = c;
      }
    }
    return choice;
  };
  std::vector<std::uint32_t> added;
  const auto add = [&](std::uint32_t choice) {
    const std::uint32_t number = parts.add();
    degree.push_back(static_cast<std::uint32_t>(edges[choice].size()));
    for (const std::uint32_t i : edges[choice]) {
      ++degree[i];
      parts.join(i, number);
      neighbours[i].push_back(number);
    }
    neighbours.push_back(edges[choice]);
    added.push_back(choice);
    positions.push_back(candidates[choice].position);
    close_near(candidates[choice].position);
    geometry::parallel_for(candidates.size(), threads, [&](std::size_t c) {
      if (is_open[c] != 0 && connects(others[choice], others[c])) edges[c].push_back(number);
    });
  };
  while (added.size() < max_photos && !is_done()) {
    std::pair<int, std::size_t> best{0, 0};  // Value, then number of edges.
    std::uint32_t choice = none;
    for (std::uint32_t c = 0; c < candidates.size(); ++c) {
      if (is_open[c] == 0 || edges[c].empty()) continue;
      std::set<std::uint32_t> joined;
      int raised = 0;
      for (const std::uint32_t i : edges[c]) {
        joined.insert(parts.root(i));
        if (degree[i] < degree_wanted) ++raised;
      }
      const int worth = 10 * (static_cast<int>(joined.size()) - 1) + raised;
      if (worth > 0 && std::pair(worth, edges[c].size()) > best) {
        best = {worth, edges[c].size()};
        choice = c;
      }
    }
    if (choice == none) choice = step_towards_another_part();
    if (choice == none) break;
    add(choice);
  }

  // Returns the candidate that registers and lets most other photos register, or none.
  const auto best_for_registration = [&](const std::vector<char>& is_registered) {
    std::vector<std::uint32_t> edges_to_registered(neighbours.size(), 0);
    for (std::uint32_t i = 0; i < neighbours.size(); ++i) {
      for (const std::uint32_t j : neighbours[i]) edges_to_registered[i] += is_registered[j] != 0;
    }
    std::pair<std::size_t, std::size_t> best{0, 0};  // Photos that register, photos outside.
    std::uint32_t choice = none;
    for (std::uint32_t c = 0; c < candidates.size(); ++c) {
      if (is_open[c] == 0) continue;
      std::size_t inside = 0, outside = 0, registering = 0;
      for (const std::uint32_t i : edges[c]) {
        if (is_registered[i] != 0) {
          ++inside;
        } else {
          ++outside;
          registering += edges_to_registered[i] + 1 >= edges_to_register;
        }
      }
      const std::pair value(registering, outside);
      if (inside >= edges_to_register && value > best) best = value, choice = c;
    }
    return choice;
  };
  while (added.size() < max_photos && is_done()) {
    const std::vector<char> is_registered = largest_registration(neighbours);
    if (std::ranges::count(is_registered, 0) == 0) break;
    const std::uint32_t choice = best_for_registration(is_registered);
    if (choice == none) break;
    add(choice);
  }
  return added;
}

}  // namespace skycap::survey::photo
