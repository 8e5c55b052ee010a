#include "survey/see/nearest_views.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <numeric>

namespace skycap::survey::see {
namespace {

using Eigen::Vector3d;

/// Cube of the octree.
struct Cube {
  Vector3d min_corner;
  double edge;

  bool contains(const Vector3d& point) const {
    return (point.array() >= min_corner.array()).all() &&
           (point.array() < (min_corner.array() + edge)).all();
  }
  Cube child(int octant) const {
    const double half = 0.5 * edge;
    return {min_corner + half * Vector3d(octant & 1, (octant >> 1) & 1, (octant >> 2) & 1), half};
  }
  int find_octant(const Vector3d& point) const {
    const Vector3d middle = min_corner + 0.5 * edge * Vector3d::Ones();
    return (point.x() >= middle.x() ? 1 : 0) | (point.y() >= middle.y() ? 2 : 0) |
           (point.z() >= middle.z() ? 4 : 0);
  }
  double squared_distance_to_centre(const Vector3d& point) const {
    return (min_corner + 0.5 * edge * Vector3d::Ones() - point).squaredNorm();
  }
};

/// Starts with a leaf around the first position and doubles it towards each other position until it
/// contains all.
Cube grow_root(std::span<const Vector3d> positions, double leaf_size) {
  Cube root{positions[0] - 0.5 * leaf_size * Vector3d::Ones(), leaf_size};
  for (const Vector3d& position : positions) {
    while (!root.contains(position)) {
      for (int axis = 0; axis < 3; ++axis) {
        if (position[axis] < root.min_corner[axis]) root.min_corner[axis] -= root.edge;
      }
      root.edge *= 2.0;
    }
  }
  return root;
}

}  // namespace

std::vector<std::size_t> nearest_views(std::span<const Vector3d> positions, const Vector3d& query,
                                       std::size_t count) {
  count = std::min(count, positions.size());
  std::vector<double> distances;
  distances.reserve(positions.size());
  for (const Vector3d& position : positions) distances.push_back((position - query).squaredNorm());

  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto nearer = [&](std::size_t a, std::size_t b) {
    return distances[a] != distances[b] ? distances[a] < distances[b] : a < b;
  };
  const auto last = order.begin() + static_cast<std::ptrdiff_t>(count);
  if (last != order.end()) std::nth_element(order.begin(), last, order.end(), nearer);
  std::sort(order.begin(), last, nearer);
  order.resize(count);
  return order;
}

std::size_t nearest_view(std::span<const Vector3d> positions, const Vector3d& query,
                         const Vector3d& first_view, double first_view_weight) {
  constexpr double tie = 1e-9;
  std::size_t best = 0;
  double best_cost = std::numeric_limits<double>::infinity(), best_from_first = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double from_first = (positions[i] - first_view).norm();
    const double cost = (positions[i] - query).norm() + first_view_weight * from_first;
    const bool better =
        cost < best_cost - tie || (cost < best_cost + tie && from_first < best_from_first - tie);
    if (!better) continue;
    best = i;
    best_cost = cost;
    best_from_first = from_first;
  }
  return best;
}

std::size_t approximately_nearest_view(std::span<const Vector3d> positions, const Vector3d& query,
                                       double leaf_size) {
  assert(!positions.empty());
  Cube cube = grow_root(positions, leaf_size);
  std::vector<std::size_t> inside(positions.size());
  std::iota(inside.begin(), inside.end(), std::size_t{0});
  while (cube.edge > 1.5 * leaf_size) {
    std::vector<std::size_t> children[8];
    for (const std::size_t index : inside)
      children[cube.find_octant(positions[index])].push_back(index);
    int nearest_child = -1;
    double nearest_distance = std::numeric_limits<double>::infinity();
    for (int octant = 0; octant < 8; ++octant) {
      if (children[octant].empty()) continue;
      const double distance = cube.child(octant).squared_distance_to_centre(query);
      if (distance >= nearest_distance) continue;
      nearest_distance = distance;
      nearest_child = octant;
    }
    inside = std::move(children[nearest_child]);
    cube = cube.child(nearest_child);
  }
  return *std::min_element(inside.begin(), inside.end(), [&](std::size_t a, std::size_t b) {
    const double to_a = (positions[a] - query).squaredNorm();
    const double to_b = (positions[b] - query).squaredNorm();
    return to_a != to_b ? to_a < to_b : a < b;
  });
}

}  // namespace skycap::survey::see
