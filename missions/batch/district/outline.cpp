#include "missions/batch/district/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "geometry/pose/prism.h"

namespace skycap::missions::batch {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Maximum height of base faces above the lowest vertex [m].
constexpr double foot_height = 0.5;

/// Position rounded to centimetres, because adjacent faces rarely have exactly equal corners.
using Corner = std::pair<std::int64_t, std::int64_t>;
using Edge = std::pair<Corner, Corner>;

Corner make_corner(const Vector3d& vertex) {
  return {std::llround(100.0 * vertex.x()), std::llround(100.0 * vertex.y())};
}

Vector2d to_position(const Corner& corner) {
  return 0.01 * Vector2d(static_cast<double>(corner.first), static_cast<double>(corner.second));
}

/// Returns the edges that belong to exactly one base face.
std::set<Edge> find_border_edges(const geometry::Mesh& mesh) {
  double min_height = std::numeric_limits<double>::infinity();
  for (const Vector3d& vertex : mesh.vertices) min_height = std::min(min_height, vertex.z());
  std::set<Edge> border;
  for (const auto& triangle : mesh.triangles) {
    std::array<Corner, 3> corners;
    bool is_low = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d& vertex = mesh.vertices[triangle[i]];
      corners[i] = make_corner(vertex);
      is_low = is_low && vertex.z() <= min_height + foot_height;
    }
    if (!is_low) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax(corners[i], corners[(i + 1) % 3]);
      if (a == b) continue;
      if (const auto [known, is_new] = border.insert({a, b}); !is_new) border.erase(known);
    }
  }
  return border;
}

/// Chains edges into rings. Returns an empty list if a ring is not closed.
std::vector<Ring> chained(const std::set<Edge>& border) {
  std::map<Corner, std::set<Corner>> next;
  for (const auto& [a, b] : border) {
    next[a].insert(b);
    next[b].insert(a);
  }
  std::vector<Ring> rings;
  while (!next.empty()) {
    const Corner start = next.begin()->first;
    Ring& ring = rings.emplace_back();
    Corner here = start;
    do {
      ring.push_back(to_position(here));
      const auto found = next.find(here);
      if (found == next.end() || found->second.empty()) return {};
      const Corner to = *found->second.begin();
      found->second.erase(to);
      if (found->second.empty()) next.erase(found);
      next[to].erase(here);
      if (next[to].empty()) next.erase(to);
      here = to;
    } while (here != start);
    if (ring.size() < 3) return {};
  }
  return rings;
}

}  // namespace

std::vector<Ring> compute_outline(const geometry::Mesh& mesh) {
  std::vector<Ring> rings = chained(find_border_edges(mesh));
  if (!rings.empty()) return rings;
  std::vector<Vector2d> positions;
  for (const Vector3d& vertex : mesh.vertices) positions.push_back(vertex.head<2>());
  return {convex_hull(std::move(positions))};
}

// Implements Andrew's monotone chain algorithm (1979).
Ring convex_hull(std::vector<Vector2d> positions) {
  const auto less = [](const Vector2d& a, const Vector2d& b) {
    return std::tuple(a.x(), a.y()) < std::tuple(b.x(), b.y());
  };
  std::ranges::sort(positions, less);
  Ring hull;
  const auto add = [&](const Vector2d& position, std::size_t fixed) {
    while (hull.size() > fixed &&
           geometry::turn(hull[hull.size() - 2], hull.back(), position) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(position);
  };
  for (const Vector2d& position : positions) add(position, 1);
  const std::size_t upper = hull.size();
  for (auto position = positions.rbegin() + 1; position < positions.rend(); ++position)
    add(*position, upper);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

}  // namespace skycap::missions::batch
