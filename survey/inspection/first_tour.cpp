#include "survey/inspection/first_tour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include "geometry/error.h"
#include "geometry/interrupted.h"
#include "geometry/parallel.h"

namespace skycap::survey::inspection {
namespace {

using Eigen::Array3i;
using Eigen::Vector3d;

constexpr int yaw_steps = 12, pitch_steps = 5;
constexpr double max_pitch_step = 60.0 * geometry::radians_per_degree;
constexpr double vertex_spacing = 4.0;

/// Candidate in its best direction.
struct TourView {
  Vertex pose;
  std::vector<std::uint32_t> seen;  // targets at the required level
};

TourView best_direction(const SightCells& cells, const Vector3d& position,
                        const TourOptions& options) {
  TourView best;
  best.pose.position = position;
  std::vector<PointSight> sights;
  for (int j = 0; j < pitch_steps; ++j) {
    const double pitch = std::clamp(max_pitch_step * (2.0 * j / (pitch_steps - 1) - 1.0),
                                    options.pitch.min, options.pitch.max);
    for (int i = 0; i < yaw_steps; ++i) {
      const double yaw =
          std::remainder(2.0 * std::numbers::pi * i / yaw_steps, 2.0 * std::numbers::pi);
      sights.clear();
      cells.add_view(position, yaw, pitch, options.targets, options.level, sights);
      if (sights.size() <= best.seen.size()) continue;
      best.pose.yaw = yaw;
      best.pose.pitch = pitch;
      best.seen.clear();
      for (const PointSight& sight : sights) best.seen.push_back(sight.point());
    }
  }
  return best;
}

/// Returns views that cover the required share of the attainable targets, most useful first.
std::vector<Vertex> cover_targets(const std::vector<TourView>& views,
                                  const ViewCandidates& candidates, const TourOptions& options) {
  std::size_t attainable = 0;
  for (std::size_t i = 0; i < options.targets; ++i) {
    if (candidates.attainable[i] >= options.level) ++attainable;
  }
  const auto required =
      static_cast<std::size_t>(std::ceil(options.share * static_cast<double>(attainable)));
  constexpr double min_gain_share = 0.0015;
  const double min_gain = min_gain_share * static_cast<double>(options.targets);
  std::vector<std::uint8_t> is_seen(options.targets, 0);
  std::priority_queue<std::pair<std::size_t, std::uint32_t>> queue;  // gain, inverse of index
  const auto last = static_cast<std::uint32_t>(views.size());
  for (std::uint32_t i = 0; i < last; ++i) queue.emplace(views[i].seen.size(), last - i);
  std::vector<Vertex> chosen;
  std::size_t seen = 0;
  while (!queue.empty() && seen < required) {
    const auto [bound, inverse] = queue.top();
    queue.pop();
    const TourView& view = views[last - inverse];
    std::size_t gain = 0;
    for (const std::uint32_t target : view.seen) gain += is_seen[target] == 0 ? 1 : 0;
    if (!queue.empty() && std::pair(gain, inverse) < queue.top()) {
      queue.emplace(gain, inverse);
      continue;
    }
    if (gain == 0 || (!chosen.empty() && static_cast<double>(gain) < min_gain)) break;
    for (const std::uint32_t target : view.seen) is_seen[target] = 1;
    seen += gain;
    chosen.push_back(view.pose);
  }
  return chosen;
}

/// Shortest paths over the reachable nodes, with 26 neighbours.
class NodePaths {
 public:
  explicit NodePaths(const ReachableSpace& space) : space_(space) {
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const Array3i step(x, y, z);
          if (step.matrix().squaredNorm() == 0) continue;
          steps_.push_back(step);
          lengths_.push_back(space.node_spacing() *
                             std::sqrt(static_cast<double>(step.matrix().squaredNorm())));
        }
      }
    }
  }

  /// Returns the distances of all nodes from a node [m], and the previous node on the way.
  struct Tree {
    std::vector<float> distances;
    std::vector<std::uint32_t> previous;
  };
  Tree from(std::size_t start) const {
    Tree tree;
    tree.distances.assign(space_.nodes(), std::numeric_limits<float>::infinity());
    tree.previous.assign(space_.nodes(), static_cast<std::uint32_t>(start));
    const Array3i& counts = space_.node_counts();
    using Entry = std::pair<float, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    tree.distances[start] = 0.0F;
    open.emplace(0.0F, static_cast<std::uint32_t>(start));
    while (!open.empty()) {
      const auto [distance, node] = open.top();
      open.pop();
      if (distance > tree.distances[node]) continue;
      const auto flat = static_cast<int>(node);
      const Array3i at(flat % counts.x(), flat / counts.x() % counts.y(),
                       flat / (counts.x() * counts.y()));
      for (std::size_t i = 0; i < steps_.size(); ++i) {
        const Array3i next = at + steps_[i];
        if ((next < 0).any() || (next >= counts).any()) continue;
        const auto index = static_cast<std::uint32_t>(
            (static_cast<std::size_t>(next.z()) * static_cast<std::size_t>(counts.y()) +
             static_cast<std::size_t>(next.y())) *
                static_cast<std::size_t>(counts.x()) +
            static_cast<std::size_t>(next.x()));
        if (!space_.is_reachable_node(index)) continue;
        const float other = distance + static_cast<float>(lengths_[i]);
        if (other >= tree.distances[index]) continue;
        tree.distances[index] = other;
        tree.previous[index] = node;
        open.emplace(other, index);
      }
    }
    return tree;
  }

 private:
  const ReachableSpace& space_;
  std::vector<Array3i> steps_;
  std::vector<double> lengths_;
};

/// Symmetric distances between viewpoints [m].
class TourCosts {
 public:
  explicit TourCosts(std::size_t count) : count_(count), costs_(count * count, 0.0) {}
  double& at(std::size_t a, std::size_t b) { return costs_[a * count_ + b]; }
  double operator()(std::size_t a, std::size_t b) const { return costs_[a * count_ + b]; }
  std::size_t size() const { return count_; }

  double length(const std::vector<std::size_t>& order) const {
    double sum = 0.0;
    for (std::size_t i = 1; i < order.size(); ++i) sum += (*this)(order[i - 1], order[i]);
    return sum;
  }

 private:
  std::size_t count_;
  std::vector<double> costs_;
};

std::vector<std::size_t> nearest_neighbour_tour(const TourCosts& costs, std::size_t start) {
  std::vector<std::size_t> order{start};
  std::vector<std::uint8_t> is_used(costs.size(), 0);
  is_used[start] = 1;
  while (order.size() < costs.size()) {
    std::size_t nearest = costs.size();
    for (std::size_t i = 0; i < costs.size(); ++i) {
      if (is_used[i] != 0) continue;
      if (nearest == costs.size() || costs(order.back(), i) < costs(order.back(), nearest)) {
        nearest = i;
      }
    }
    is_used[nearest] = 1;
    order.push_back(nearest);
  }
  return order;
}

/// Cost between two positions of an open tour; outside of it, 0.
double step_cost(const TourCosts& costs, const std::vector<std::size_t>& order,
                 std::ptrdiff_t before, std::ptrdiff_t after) {
  const auto size = static_cast<std::ptrdiff_t>(order.size());
  if (before < 0 || after >= size) return 0.0;
  return costs(order[static_cast<std::size_t>(before)], order[static_cast<std::size_t>(after)]);
}

bool improve_by_reversal(const TourCosts& costs, std::vector<std::size_t>& order) {
  const auto size = static_cast<std::ptrdiff_t>(order.size());
  constexpr double min_improvement = 1e-9;
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    for (std::ptrdiff_t j = i + 1; j < size; ++j) {
      const double before = step_cost(costs, order, i - 1, i) + step_cost(costs, order, j, j + 1);
      const double after = step_cost(costs, order, i - 1, j) + step_cost(costs, order, i, j + 1);
      if (after >= before - min_improvement) continue;
      std::reverse(order.begin() + i, order.begin() + j + 1);
      return true;
    }
  }
  return false;
}

bool improve_by_moving(const TourCosts& costs, std::vector<std::size_t>& order) {
  const auto size = static_cast<std::ptrdiff_t>(order.size());
  constexpr std::ptrdiff_t max_chain = 3;
  const double before = costs.length(order);
  constexpr double min_improvement = 1e-9;
  for (std::ptrdiff_t length = 1; length <= std::min(max_chain, size - 1); ++length) {
    for (std::ptrdiff_t i = 0; i + length <= size; ++i) {
      const double freed = step_cost(costs, order, i - 1, i) +
                           step_cost(costs, order, i + length - 1, i + length) -
                           step_cost(costs, order, i - 1, i + length);
      for (std::ptrdiff_t gap = 0; gap <= size; ++gap) {  // insertion before position `gap`
        if (gap >= i && gap <= i + length) continue;
        for (const bool is_reversed : {false, true}) {
          const std::ptrdiff_t first = is_reversed ? i + length - 1 : i;
          const std::ptrdiff_t last = is_reversed ? i : i + length - 1;
          const double added =
              (gap > 0 ? step_cost(costs, order, gap - 1, first) : 0.0) +
              (gap < size ? step_cost(costs, order, std::min(last, gap), std::max(last, gap))
                          : 0.0) -
              step_cost(costs, order, gap - 1, gap);
          if (added >= freed - min_improvement) continue;
          std::vector<std::size_t> chain(order.begin() + i, order.begin() + i + length);
          if (is_reversed) std::ranges::reverse(chain);
          std::vector<std::size_t> moved = order;
          moved.erase(moved.begin() + i, moved.begin() + i + length);
          const std::ptrdiff_t at = gap > i ? gap - length : gap;
          moved.insert(moved.begin() + at, chain.begin(), chain.end());
          if (costs.length(moved) >= before - min_improvement) continue;
          order = std::move(moved);
          return true;
        }
      }
    }
  }
  return false;
}

std::vector<std::size_t> short_open_tour(const TourCosts& costs) {
  constexpr std::size_t starts = 12;
  std::vector<std::size_t> best;
  for (std::size_t i = 0; i < std::min(starts, costs.size()); ++i) {
    std::vector<std::size_t> order =
        nearest_neighbour_tour(costs, i * costs.size() / std::min(starts, costs.size()));
    while (improve_by_reversal(costs, order) || improve_by_moving(costs, order)) {
    }
    if (best.empty() || costs.length(order) < costs.length(best)) best = std::move(order);
  }
  return best;
}

/// Removes positions of a path that can be skipped in a straight line.
std::vector<Vector3d> shortened(const ReachableSpace& space, const std::vector<Vector3d>& path) {
  std::vector<Vector3d> result{path.front()};
  std::size_t at = 0;
  while (at + 1 < path.size()) {
    std::size_t next = path.size() - 1;
    while (next > at + 1 && !space.is_clear(path[at], path[next])) --next;
    result.push_back(path[next]);
    at = next;
  }
  return result;
}

/// Appends vertices along a path to `to`, about every `vertex_spacing`, with the pose interpolated.
void append_path(const std::vector<Vector3d>& path, const Vertex& to,
                 std::vector<Vertex>& vertices) {
  const Vertex from = vertices.back();
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
  const double turn = std::remainder(to.yaw - from.yaw, 2.0 * std::numbers::pi);
  double flown = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vector3d step = path[i] - path[i - 1];
    const int parts = std::max(1, static_cast<int>(std::lround(step.norm() / vertex_spacing)));
    for (int part = 1; part <= parts; ++part) {
      const double share = static_cast<double>(part) / parts;
      const double along = length > 0.0 ? (flown + share * step.norm()) / length : 1.0;
      Vertex vertex;
      vertex.position = path[i - 1] + share * step;
      vertex.yaw = std::remainder(from.yaw + along * turn, 2.0 * std::numbers::pi);
      vertex.pitch = from.pitch + along * (to.pitch - from.pitch);
      vertices.push_back(vertex);
    }
    flown += step.norm();
  }
}

std::vector<Vertex> join_views(const ReachableSpace& space, const std::vector<Vertex>& views,
                               unsigned threads, const std::stop_token& stop) {
  std::vector<std::size_t> nodes;
  for (const Vertex& view : views)
    nodes.push_back(space.reachable_node_near(view.position).value());
  const NodePaths paths(space);
  TourCosts costs(views.size());
  geometry::parallel_for(views.size(), threads, [&](std::size_t i) {
    if (stop.stop_requested()) throw skycap::Interrupted();
    const NodePaths::Tree tree = paths.from(nodes[i]);
    for (std::size_t j = 0; j < views.size(); ++j) {
      costs.at(i, j) = static_cast<double>(tree.distances[nodes[j]]);
    }
  });
  for (std::size_t i = 0; i < views.size(); ++i) {  // sums differ in their order by rounding
    for (std::size_t j = 0; j < i; ++j) costs.at(i, j) = costs.at(j, i);
  }
  const std::vector<std::size_t> order = short_open_tour(costs);
  std::vector<std::vector<Vector3d>> legs(order.size());
  geometry::parallel_for(order.size() - 1, threads, [&](std::size_t i) {
    const NodePaths::Tree tree = paths.from(nodes[order[i]]);
    std::vector<Vector3d> path{views[order[i + 1]].position};
    for (std::size_t node = nodes[order[i + 1]]; node != nodes[order[i]];
         node = tree.previous[node]) {
      path.push_back(space.node_position(node));
    }
    path.push_back(views[order[i]].position);
    std::ranges::reverse(path);
    legs[i] = shortened(space, path);
  });
  std::vector<Vertex> vertices{views[order.front()]};
  for (std::size_t i = 0; i + 1 < order.size(); ++i) {
    append_path(legs[i], views[order[i + 1]], vertices);
  }
  return vertices;
}

}  // namespace

ViewCandidates draw_candidates(const ReachableSpace& space, const SightCells& cells,
                               const TourOptions& options, geometry::RandomNumbers& random) {
  const double range = cells.camera().range, clearance = space.required_distance();
  const double nearest = clearance + std::min(0.3, 0.1 * (range - clearance));
  const double farthest = std::max(clearance + 0.6 * (range - clearance), nearest);
  std::vector<std::size_t> nodes;
  for (std::size_t node = 0; node < space.nodes(); ++node) {
    if (!space.is_reachable_node(node)) continue;
    const double distance = space.distance(space.node_position(node));
    if (distance >= nearest && distance <= farthest) nodes.push_back(node);
  }
  if (nodes.empty()) {
    throw Error(ErrorKind::bad_geometry,
                "no reachable position has a distance from the structure between the clearance and "
                "the range; "
                "lower the clearance or raise the range");
  }
  for (std::size_t i = 0; i + 1 < nodes.size() && i < options.candidates; ++i) {
    const std::size_t other = i + random() % (nodes.size() - i);
    std::swap(nodes[i], nodes[other]);
  }
  nodes.resize(std::min(nodes.size(), options.candidates));
  ViewCandidates candidates;
  for (const std::size_t node : nodes) candidates.positions.push_back(space.node_position(node));

  const std::size_t points = cells.cloud().size();
  const double min_elevation = options.pitch.min - 0.5 * cells.camera().vertical_fov;
  const double max_elevation = options.pitch.max + 0.5 * cells.camera().vertical_fov;
  const unsigned threads = geometry::thread_count(options.threads);
  std::vector<std::vector<std::uint8_t>> levels(threads, std::vector<std::uint8_t>(points, 0));
  geometry::parallel_for(threads, threads, [&](std::size_t task) {
    for (std::size_t i = task; i < candidates.positions.size(); i += threads) {
      const Vector3d& position = candidates.positions[i];
      for (const std::uint32_t entry : cells.entries(position)) {
        const std::uint32_t point = entry >> 1;
        const Vector3d line = cells.cloud().points[point].cast<double>() - position;
        const double elevation = std::atan2(line.z(), line.head<2>().norm());
        if (elevation < min_elevation || elevation > max_elevation) continue;
        const auto level = static_cast<std::uint8_t>(cells.level(position, point));
        levels[task][point] = std::max(levels[task][point], level);
      }
    }
  });
  candidates.attainable.assign(points, 0);
  for (const std::vector<std::uint8_t>& part : levels) {
    for (std::size_t i = 0; i < points; ++i) {
      candidates.attainable[i] = std::max(candidates.attainable[i], part[i]);
    }
  }
  return candidates;
}

std::vector<Vertex> make_first_tour(const ReachableSpace& space, const SightCells& cells,
                                    const ViewCandidates& candidates, const TourOptions& options,
                                    const std::stop_token& stop) {
  std::vector<TourView> views(candidates.positions.size());
  geometry::parallel_for(views.size(), options.threads, [&](std::size_t i) {
    if (stop.stop_requested()) throw skycap::Interrupted();
    views[i] = best_direction(cells, candidates.positions[i], options);
  });
  const std::vector<Vertex> chosen = cover_targets(views, candidates, options);
  if (chosen.empty()) {
    throw Error(ErrorKind::bad_geometry,
                "no reachable position sees the structure within the range and the gimbal's "
                "limits; raise the range or lower the clearance");
  }
  if (chosen.size() == 1) return chosen;
  return join_views(space, chosen, options.threads, stop);
}

}  // namespace skycap::survey::inspection
