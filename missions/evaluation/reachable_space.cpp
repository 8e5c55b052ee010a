#include "missions/evaluation/reachable_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace skycap::missions::evaluation {
namespace {

using Eigen::Vector3d;

constexpr double cells_a_radius = 8.0;
constexpr double cells_a_side = 300.0;
constexpr int nearby = 2;  // search radius of leads_to() in finest cells

// States of leaves. Smaller values are the index of the first of eight children.
constexpr std::uint32_t closed = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t open = closed - 1;
constexpr std::uint32_t reached = closed - 2;

// State of a cell to be subdivided. It is unambiguous, because the root is never a child.
constexpr std::uint32_t divided = 0;

/// Position of a cell relative to the height range of paths.
enum class Heights { outside, partly, inside };

using GridPoint = std::array<std::int32_t, 3>;

GridPoint child_corner(const GridPoint& corner, std::int32_t half, std::uint32_t child) {
  GridPoint location = corner;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (child >> axis & 1U) location[axis] += half;
  }
  return location;
}

/// Returns offsets to the surrounding finest cells, nearest first.
const std::vector<GridPoint>& steps_around() {
  static const auto steps = [] {
    std::vector<GridPoint> all;
    for (int x = -nearby; x <= nearby; ++x) {
      for (int y = -nearby; y <= nearby; ++y) {
        for (int z = -nearby; z <= nearby; ++z) all.push_back({x, y, z});
      }
    }
    const auto length = [](const GridPoint& step) {
      return step[0] * step[0] + step[1] * step[1] + step[2] * step[2];
    };
    std::ranges::stable_sort(all, {}, length);
    return all;
  }();
  return steps;
}

}  // namespace

bool ReachableSpace::is_leaf(std::uint32_t node) { return node >= reached; }

ReachableSpace::ReachableSpace(const geometry::MeshDistance& surface,
                               const Eigen::AlignedBox3d& box, const Config& config,
                               const Joins& joins) {
  lay_out(box, config);
  grow(surface, config);
  std::vector<Cell> pending;
  if (!config.start || !is_inside(grid_point(*config.start))) {
    reach_outside(pending);
  } else {
    visit_near(*config.start, [&](const Cell& cell) {
      const bool is_own = cell_box(cell).contains(*config.start);
      if (nodes_[cell.node] == open &&
          (is_own || joins(*config.start, nearest(cell, *config.start)))) {
        reach(cell, pending);
      }
      return is_own && nodes_[cell.node] != closed;
    });
  }
  flood(std::move(pending));
}

void ReachableSpace::lay_out(Eigen::AlignedBox3d box, const Config& config) {
  cell_ = std::max(config.radius / cells_a_radius, box.sizes().maxCoeff() / cells_a_side);
  // A layer of open cells around the box.
  const Vector3d margin = Vector3d::Constant(config.radius + 2.0 * cell_);
  box = Eigen::AlignedBox3d(box.min() - margin, box.max() + margin);
  is_floored_ = config.min_height && *config.min_height > box.min().z();
  if (is_floored_) {
    box.min().z() = *config.min_height;
    box.max().z() = std::max(box.max().z(), box.min().z() + cell_);
  }
  while (width_ * cell_ < box.sizes().maxCoeff()) width_ *= 2;
  origin_ = box.min();
  const Eigen::Vector2d excess = Eigen::Vector2d::Constant(width_ * cell_) - box.sizes().head<2>();
  origin_.head<2>() -= 0.5 * excess;
}

/// Builds the octree by levels, so that distances are computed for many cells at once.
void ReachableSpace::grow(const geometry::MeshDistance& surface, const Config& config) {
  nodes_ = {closed};
  std::vector<Cell> level{{0, {}, width_}};
  while (!level.empty()) {
    const std::vector<std::uint32_t> states = compute_states(level, surface, config);
    std::vector<Cell> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      const Cell& cell = level[i];
      nodes_[cell.node] = states[i];
      if (is_leaf(states[i])) continue;
      const auto first = static_cast<std::uint32_t>(nodes_.size());
      nodes_[cell.node] = first;
      nodes_.resize(first + 8, closed);
      const std::int32_t half = cell.size / 2;
      for (std::uint32_t child = 0; child < 8; ++child) {
        next.push_back({first + child, child_corner(cell.corner, half, child), half});
      }
    }
    level = std::move(next);
  }
  std::vector<std::uint32_t> nodes(1);
  nodes[0] = merged(0, nodes);
  nodes_ = std::move(nodes);
}

/// Determines whether cells of one size are closed, open, or to be subdivided.
std::vector<std::uint32_t> ReachableSpace::compute_states(std::span<const Cell> cells,
                                                          const geometry::MeshDistance& surface,
                                                          const Config& config) const {
  std::vector<std::uint32_t> states(cells.size(), closed);
  std::vector<std::size_t> asked;
  std::vector<Vector3d> centres;
  const auto heights = [&](const Cell& cell) {
    const double low = origin_.z() + cell_ * cell.corner[2], high = low + cell_ * cell.size;
    const double min = config.min_height.value_or(low);
    const double max = config.max_height.value_or(high);
    return high <= min || low >= max   ? Heights::outside
           : low >= min && high <= max ? Heights::inside
                                       : Heights::partly;
  };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (heights(cells[i]) == Heights::outside) continue;
    const double half = 0.5 * cells[i].size;
    const auto& [x, y, z] = cells[i].corner;
    asked.push_back(i);
    centres.emplace_back(origin_ + cell_ * Vector3d(x + half, y + half, z + half));
  }
  std::vector<double> distances(centres.size());
  surface.distances(centres, distances, config.threads);
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const Cell& cell = cells[asked[k]];
    const double ball = std::sqrt(3.0) * 0.5 * cell.size * cell_;
    if (distances[k] + ball < config.radius) continue;
    const bool is_far = distances[k] >= config.radius + ball;
    if (is_far && heights(cell) == Heights::inside) {
      states[asked[k]] = open;
    } else if (cell.size > 1) {
      states[asked[k]] = divided;
    }
  }
  return states;
}

/// Copies a subtree. Eight leaves with the same state are merged into one.
std::uint32_t ReachableSpace::merged(std::uint32_t node, std::vector<std::uint32_t>& nodes) const {
  const std::uint32_t from = nodes_[node];
  if (is_leaf(from)) return from;
  const auto first = static_cast<std::uint32_t>(nodes.size());
  nodes.resize(first + 8);
  for (std::uint32_t i = 0; i < 8; ++i) {
    const std::uint32_t state = merged(from + i, nodes);
    nodes[first + i] = state;
  }
  const std::uint32_t state = nodes[first];
  const auto is_other = [&](std::uint32_t child) { return child != state; };
  if (!is_leaf(state) || std::any_of(nodes.begin() + first, nodes.end(), is_other)) return first;
  nodes.resize(first);
  return state;
}

ReachableSpace::GridPoint ReachableSpace::grid_point(const Vector3d& point) const {
  GridPoint location{};
  for (int axis = 0; axis < 3; ++axis) {
    const double cells = std::floor((point[axis] - origin_[axis]) / cell_);
    location[static_cast<std::size_t>(axis)] =
        static_cast<std::int32_t>(std::clamp(cells, -1.0, static_cast<double>(width_)));
  }
  return location;
}

bool ReachableSpace::is_inside(const GridPoint& location) const {
  return std::ranges::all_of(location, [&](std::int32_t at) { return at >= 0 && at < width_; });
}

Eigen::AlignedBox3d ReachableSpace::cell_box(const Cell& cell) const {
  const Vector3d low = origin_ + cell_ * Vector3d(cell.corner[0], cell.corner[1], cell.corner[2]);
  return {low, low + Vector3d::Constant(cell_ * cell.size)};
}

ReachableSpace::Cell ReachableSpace::cell_at(const GridPoint& location,
                                             std::int32_t min_size) const {
  Cell cell{0, {}, width_};
  while (cell.size > min_size && !is_leaf(nodes_[cell.node])) {
    const std::int32_t half = cell.size / 2;
    std::uint32_t child = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (location[axis] >= cell.corner[axis] + half) child |= 1U << axis;
    }
    cell = {nodes_[cell.node] + child, child_corner(cell.corner, half, child), half};
  }
  return cell;
}

template <class Visit>
void ReachableSpace::visit_face(const Cell& cell, std::size_t axis, bool is_upper,
                                const Visit& visit) const {
  if (is_leaf(nodes_[cell.node])) return visit(cell);
  for (std::uint32_t child = 0; child < 8; ++child) {
    if ((child >> axis & 1U) != (is_upper ? 1U : 0U)) continue;
    const std::int32_t half = cell.size / 2;
    visit_face({nodes_[cell.node] + child, child_corner(cell.corner, half, child), half}, axis,
               is_upper, visit);
  }
}

template <class Visit>
bool ReachableSpace::visit_near(const Vector3d& point, const Visit& visit) const {
  const GridPoint own = grid_point(point);
  for (const GridPoint& step : steps_around()) {
    const GridPoint location{own[0] + step[0], own[1] + step[1], own[2] + step[2]};
    if (is_inside(location) && visit(cell_at(location, 1))) return true;
  }
  return false;
}

bool ReachableSpace::leads_to(const Vector3d& location, const Joins& joins) const {
  const GridPoint own = grid_point(location);
  if (!is_inside(own)) return is_outside_reached_;
  const std::uint32_t state = nodes_[cell_at(own, 1).node];
  if (state != closed) return state == reached;
  return visit_near(location, [&](const Cell& cell) {
    return nodes_[cell.node] == reached && joins(location, nearest(cell, location));
  });
}

Vector3d ReachableSpace::nearest(const Cell& cell, const Vector3d& location) const {
  const Eigen::AlignedBox3d box = cell_box(cell);
  return location.cwiseMax(box.min()).cwiseMin(box.max());
}

void ReachableSpace::reach(const Cell& cell, std::vector<Cell>& pending) {
  if (nodes_[cell.node] != open) return;
  nodes_[cell.node] = reached;
  is_empty_ = false;
  pending.push_back(cell);
}

void ReachableSpace::reach_outside(std::vector<Cell>& pending) {
  if (is_outside_reached_) return;
  is_outside_reached_ = true;
  is_empty_ = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool is_upper : {false, true}) {
      if (axis == 2 && !is_upper && is_floored_) continue;
      visit_face({0, {}, width_}, axis, is_upper, [&](const Cell& cell) { reach(cell, pending); });
    }
  }
}

void ReachableSpace::flood(std::vector<Cell> pending) {
  while (!pending.empty()) {
    const Cell cell = pending.back();
    pending.pop_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const bool is_upper : {false, true}) {
        GridPoint beyond = cell.corner;
        beyond[axis] += is_upper ? cell.size : -1;
        if (is_inside(beyond)) {
          visit_face(cell_at(beyond, cell.size), axis, !is_upper,
                     [&](const Cell& neighbour) { reach(neighbour, pending); });
        } else if (axis != 2 || is_upper || !is_floored_) {
          reach_outside(pending);
        }
      }
    }
  }
}

}  // namespace skycap::missions::evaluation
