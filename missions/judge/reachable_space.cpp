#include "missions/judge/reachable_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "flight/space/segment_distance.h"
#include "geometry/parallel.h"

namespace skycap::missions::judge {
namespace {

using Eigen::Vector3d;

constexpr double cells_a_radius = 8.0;
constexpr double cells_a_side = 300.0;
constexpr std::int32_t tasks_a_side = 8;  // at most; subtrees that are grown each by one thread
constexpr int nearby = 2;                 // leads_to() looks so many finest cells around

// States of leaves; smaller numbers are the first of eight children.
constexpr std::uint32_t closed = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t open = closed - 1;
constexpr std::uint32_t reached = closed - 2;

bool is_leaf(std::uint32_t node) { return node >= reached; }

// Of a node whose children are grown later; the root is nobody's child.
constexpr std::uint32_t unfinished = 0;

using Place = std::array<std::int32_t, 3>;

Place child_of(const Place& corner, std::int32_t half, std::uint32_t child) {
  Place place = corner;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (child >> axis & 1U) place[axis] += half;
  }
  return place;
}

/// Steps to the finest cells around one, nearest first.
const std::vector<Place>& steps_around() {
  static const auto steps = [] {
    std::vector<Place> all;
    for (int x = -nearby; x <= nearby; ++x) {
      for (int y = -nearby; y <= nearby; ++y) {
        for (int z = -nearby; z <= nearby; ++z) all.push_back({x, y, z});
      }
    }
    const auto length = [](const Place& step) {
      return step[0] * step[0] + step[1] * step[1] + step[2] * step[2];
    };
    std::ranges::stable_sort(all, {}, length);
    return all;
  }();
  return steps;
}

/// A triangle with what rules it out quickly.
struct Facet {
  flight::Triangle corners;
  Vector3d centre, normal;
  double radius;  // of the ball around the centre that holds it
};

std::vector<Facet> facets_of(const geometry::Mesh& mesh) {
  std::vector<Facet> facets;
  for (const auto& [a, b, c] : mesh.triangles) {
    const flight::Triangle corners{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (!(normal.norm() > 0.0)) continue;
    const Vector3d centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    double radius = 0.0;
    for (const Vector3d& corner : corners) radius = std::max(radius, (corner - centre).norm());
    facets.push_back({corners, centre, normal.normalized(), radius});
  }
  return facets;
}

}  // namespace

/// Grows the octree below one cell, into nodes of its own.
struct ReachableSpace::Grower {
  /// A cell that is left to be divided by another grower.
  struct Task {
    std::uint32_t node;
    Place corner;
    std::vector<std::uint32_t> near;
  };

  const std::vector<Facet>& facets;
  const Config& config;
  double side;  // of the finest cells
  Vector3d origin;
  std::int32_t task_size = 0;  // of cells that are left to others
  std::vector<std::uint32_t> nodes;
  std::vector<Task> tasks;

  enum class Distance { far, near, within };

  /// Where a ball around `centre` is: every place of it far from the facet, perhaps not, or every
  /// place of it within the radius of the facet.
  Distance distance(const Facet& facet, const Vector3d& centre, double ball, bool is_finest) const {
    const double reach = config.radius + ball, to_centre = (centre - facet.centre).norm();
    if (to_centre >= reach + facet.radius) return Distance::far;
    if (to_centre + ball < config.radius) return Distance::within;
    // The facet's centre is a place of it: of finest cells no more is asked.
    if (is_finest ? to_centre < reach : facet.radius < 0.5 * ball) return Distance::near;
    if (std::abs(facet.normal.dot(centre - facet.centre)) >= reach) return Distance::far;
    const double exact =
        std::sqrt(flight::nearest(flight::Segment{centre, centre}, facet.corners).squared_distance);
    if (exact >= reach) return Distance::far;
    return exact + ball < config.radius ? Distance::within : Distance::near;
  }

  /// The state of a cell, or the first of the children that it was divided into.
  std::uint32_t grow(const Place& corner, std::int32_t size,
                     const std::vector<std::uint32_t>& around) {
    const double low = origin.z() + side * corner[2], high = low + side * size;
    const double least = config.least_height.value_or(low);
    const double most = config.most_height.value_or(high);
    if (high <= least || low >= most) return closed;
    const double half = 0.5 * size;
    const Vector3d centre =
        origin + side * Vector3d(corner[0] + half, corner[1] + half, corner[2] + half);
    std::vector<std::uint32_t> near;
    for (const std::uint32_t i : around) {
      const Distance found = distance(facets[i], centre, std::sqrt(3.0) * half * side, size == 1);
      if (found == Distance::within || (size == 1 && found == Distance::near)) return closed;
      if (found == Distance::near) near.push_back(i);
    }
    if (near.empty() && low >= least && high <= most) return open;
    if (size == 1) return closed;
    if (size != task_size) return divide(corner, size, near);
    tasks.push_back({0, corner, std::move(near)});
    return unfinished;
  }

  std::uint32_t divide(const Place& corner, std::int32_t size,
                       const std::vector<std::uint32_t>& near) {
    const auto first = static_cast<std::uint32_t>(nodes.size());
    nodes.resize(first + 8, closed);
    const std::int32_t half = size / 2;
    for (std::uint32_t i = 0; i < 8; ++i) {
      const std::uint32_t state = grow(child_of(corner, half, i), half, near);
      nodes[first + i] = state;
      if (state == unfinished) tasks.back().node = first + i;
    }
    const auto children = nodes.begin() + first;
    if (!is_leaf(*children) ||
        std::any_of(children, nodes.end(), [&](std::uint32_t node) { return node != *children; })) {
      return first;
    }
    const std::uint32_t state = *children;
    nodes.resize(first);
    return state;
  }
};

ReachableSpace::ReachableSpace(const geometry::Mesh& mesh, const Config& config,
                               const Joins& joins) {
  lay_out(geometry::bounding_box(mesh), config);
  grow(mesh, config);
  std::vector<Cell> pending;
  if (!config.start || !is_inside(place_of(*config.start))) {
    reach_outside(pending);
  } else {
    visit_near(*config.start, [&](const Cell& cell) {
      const bool is_own = box_of(cell).contains(*config.start);
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
  // Around it a layer of cells that are open for sure.
  const Vector3d margin = Vector3d::Constant(config.radius + 2.0 * cell_);
  box = Eigen::AlignedBox3d(box.min() - margin, box.max() + margin);
  is_floored_ = config.least_height && *config.least_height > box.min().z();
  if (is_floored_) {
    box.min().z() = *config.least_height;
    box.max().z() = std::max(box.max().z(), box.min().z() + cell_);
  }
  while (width_ * cell_ < box.sizes().maxCoeff()) width_ *= 2;
  origin_ = box.min();
  const Eigen::Vector2d spare = Eigen::Vector2d::Constant(width_ * cell_) - box.sizes().head<2>();
  origin_.head<2>() -= 0.5 * spare;
}

void ReachableSpace::grow(const geometry::Mesh& mesh, const Config& config) {
  const std::vector<Facet> facets = facets_of(mesh);
  std::vector<std::uint32_t> all(facets.size());
  std::iota(all.begin(), all.end(), 0U);
  Grower top{facets, config, cell_, origin_, std::max(width_ / tasks_a_side, 2), {closed}, {}};
  top.nodes[0] = top.grow({0, 0, 0}, width_, all);

  std::vector<Grower> growers(top.tasks.size(), Grower{facets, config, cell_, origin_, 0, {}, {}});
  std::vector<std::uint32_t> states(top.tasks.size());
  geometry::parallel_for(top.tasks.size(), config.threads, [&](std::size_t i) {
    states[i] = growers[i].divide(top.tasks[i].corner, top.task_size, top.tasks[i].near);
  });
  nodes_ = std::move(top.nodes);
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    const auto moved = [&](std::uint32_t node) { return is_leaf(node) ? node : first + node; };
    nodes_[top.tasks[i].node] = moved(states[i]);
    for (const std::uint32_t node : growers[i].nodes) nodes_.push_back(moved(node));
  }
}

ReachableSpace::Place ReachableSpace::place_of(const Vector3d& point) const {
  Place place{};
  for (int axis = 0; axis < 3; ++axis) {
    const double cells = std::floor((point[axis] - origin_[axis]) / cell_);
    place[static_cast<std::size_t>(axis)] =
        static_cast<std::int32_t>(std::clamp(cells, -1.0, static_cast<double>(width_)));
  }
  return place;
}

bool ReachableSpace::is_inside(const Place& place) const {
  return std::ranges::all_of(place, [&](std::int32_t at) { return at >= 0 && at < width_; });
}

Eigen::AlignedBox3d ReachableSpace::box_of(const Cell& cell) const {
  const Vector3d low = origin_ + cell_ * Vector3d(cell.corner[0], cell.corner[1], cell.corner[2]);
  return {low, low + Vector3d::Constant(cell_ * cell.size)};
}

ReachableSpace::Cell ReachableSpace::cell_at(const Place& place, std::int32_t least_size) const {
  Cell cell{0, {}, width_};
  while (cell.size > least_size && !is_leaf(nodes_[cell.node])) {
    const std::int32_t half = cell.size / 2;
    std::uint32_t child = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (place[axis] >= cell.corner[axis] + half) child |= 1U << axis;
    }
    cell = {nodes_[cell.node] + child, child_of(cell.corner, half, child), half};
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
    visit_face({nodes_[cell.node] + child, child_of(cell.corner, half, child), half}, axis,
               is_upper, visit);
  }
}

template <class Visit>
bool ReachableSpace::visit_near(const Vector3d& point, const Visit& visit) const {
  const Place own = place_of(point);
  for (const Place& step : steps_around()) {
    const Place place{own[0] + step[0], own[1] + step[1], own[2] + step[2]};
    if (is_inside(place) && visit(cell_at(place, 1))) return true;
  }
  return false;
}

bool ReachableSpace::leads_to(const Vector3d& place, const Joins& joins) const {
  const Place own = place_of(place);
  if (!is_inside(own)) return is_outside_reached_;
  const std::uint32_t state = nodes_[cell_at(own, 1).node];
  if (state != closed) return state == reached;
  return visit_near(place, [&](const Cell& cell) {
    return nodes_[cell.node] == reached && joins(place, nearest(cell, place));
  });
}

Vector3d ReachableSpace::nearest(const Cell& cell, const Vector3d& place) const {
  const Eigen::AlignedBox3d box = box_of(cell);
  return place.cwiseMax(box.min()).cwiseMin(box.max());
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
        Place beyond = cell.corner;
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

}  // namespace skycap::missions::judge
