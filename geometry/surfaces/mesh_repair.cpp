#include "geometry/surfaces/mesh_repair.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

std::uint64_t compute_hash(const Vector3d& p) {
  std::uint64_t hash = 0;
  for (const double coordinate : p) {
    // Positive and negative zero are equal, so they need the same hash.
    hash ^= std::bit_cast<std::uint64_t>(coordinate == 0.0 ? 0.0 : coordinate);
    hash *= 0x9e3779b97f4a7c15U;
    hash ^= hash >> 29;
  }
  return hash;
}

// Edge of a triangle: its ascending vertices as a key, and its position.
struct Edge {
  std::uint64_t key;
  std::uint32_t triangle;
  bool ascends;  // the triangle traverses the edge in ascending order
};

std::vector<Edge> sorted_edges(const Mesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint64_t from = mesh.triangles[t][side], to = mesh.triangles[t][(side + 1) % 3];
      edges.push_back({std::min(from, to) << 32 | std::max(from, to), t, from < to});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.key != b.key ? a.key < b.key : a.triangle < b.triangle;
  });
  return edges;
}

struct Neighbour {
  std::uint32_t triangle;
  bool agrees;  // both traverse their common edge in opposite directions, as required
};

// Returns for each triangle its neighbours across edges of exactly two triangles.
std::vector<std::vector<Neighbour>> find_neighbours(const Mesh& mesh) {
  std::vector<std::vector<Neighbour>> neighbours(mesh.triangles.size());
  const std::vector<Edge> edges = sorted_edges(mesh);
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end].key == edges[begin].key) ++end;
    if (end - begin == 2) {
      const Edge &a = edges[begin], &b = edges[begin + 1];
      const bool agrees = a.ascends != b.ascends;
      neighbours[a.triangle].push_back({b.triangle, agrees});
      neighbours[b.triangle].push_back({a.triangle, agrees});
    }
    begin = end;
  }
  return neighbours;
}

void turn_round(Mesh& mesh, std::uint32_t triangle) {
  std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
}

// Returns six times the volume between the part and its centroid. For a closed part, the result is
// independent of the centroid. For an open part, its sign shows which way the part mostly faces.
double enclosed_volume(const Mesh& mesh, const std::vector<std::uint32_t>& part) {
  Vector3d weighted = Vector3d::Zero();
  double area = 0.0;
  const auto corner = [&](std::uint32_t t, std::size_t i) -> const Vector3d& {
    return mesh.vertices[mesh.triangles[t][i]];
  };
  for (const std::uint32_t t : part) {
    const Vector3d &a = corner(t, 0), &b = corner(t, 1), &c = corner(t, 2);
    const double double_area = (b - a).cross(c - a).norm();
    weighted += double_area * (a + b + c) / 3.0;
    area += double_area;
  }
  if (!(area > 0.0)) return 0.0;
  const Vector3d centroid = weighted / area;
  double volume = 0.0;
  for (const std::uint32_t t : part) {
    volume +=
        (corner(t, 0) - centroid).dot((corner(t, 1) - centroid).cross(corner(t, 2) - centroid));
  }
  return volume;
}

}  // namespace

void weld_vertices(Mesh& mesh) {
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<bool> is_used(mesh.vertices.size(), false);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) is_used[v] = true;
  }
  // Hash table of kept vertices with linear probing. The nodes of a map would be twice as large.
  std::vector<std::uint32_t> slots(std::bit_ceil(2 * mesh.vertices.size() + 1), unused);
  std::vector<std::uint32_t> renamed(mesh.vertices.size(), unused);
  std::uint32_t kept = 0;  // kept vertices move to the front, which has already been read
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!is_used[v]) continue;
    const Vector3d vertex = mesh.vertices[v];
    std::size_t slot = compute_hash(vertex) & (slots.size() - 1);
    while (slots[slot] != unused && mesh.vertices[slots[slot]] != vertex) {
      slot = (slot + 1) & (slots.size() - 1);
    }
    if (slots[slot] == unused) {
      slots[slot] = kept;
      mesh.vertices[kept++] = vertex;
    }
    renamed[v] = slots[slot];
  }
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle) v = renamed[v];
  }
  mesh.vertices.resize(kept);
  mesh.vertices.shrink_to_fit();
}

void drop_degenerate_triangles(Mesh& mesh) {
  std::erase_if(mesh.triangles, [&](const auto& triangle) {
    const Vector3d& a = mesh.vertices[triangle[0]];
    const Vector3d& b = mesh.vertices[triangle[1]];
    const Vector3d& c = mesh.vertices[triangle[2]];
    return !((b - a).cross(c - a).squaredNorm() > 0.0);
  });
}

void orient_outward(Mesh& mesh) {
  const auto neighbours = find_neighbours(mesh);
  std::vector<bool> is_visited(mesh.triangles.size(), false);
  std::vector<bool> is_turned(mesh.triangles.size(), false);
  for (std::uint32_t seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (is_visited[seed]) continue;
    is_visited[seed] = true;
    std::vector<std::uint32_t> part{seed};
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::uint32_t triangle = part[i];
      for (const auto& [other, agrees] : neighbours[triangle]) {
        if (is_visited[other]) continue;
        is_visited[other] = true;
        is_turned[other] = agrees ? is_turned[triangle] : !is_turned[triangle];
        part.push_back(other);
        if (is_turned[other]) turn_round(mesh, other);
      }
    }
    if (enclosed_volume(mesh, part) < 0.0) {
      for (const std::uint32_t triangle : part) turn_round(mesh, triangle);
    }
  }
}

}  // namespace skycap::geometry
