#include "geometry/surfaces/mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/random_numbers.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

Vector3d area_vector(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Vector3d& a = mesh.vertices[triangle[0]];
  return 0.5 * (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a);
}

constexpr std::size_t things_in_block = 1 << 14;

std::size_t count_blocks(std::size_t count) {
  return (count + things_in_block - 1) / things_in_block;
}

/// Calls `work(block, first, end)` for each block of indices.
template <typename Work>
void for_each_block(std::size_t count, unsigned threads, Work work) {
  parallel_for(count_blocks(count), threads, [&](std::size_t block) {
    work(block, block * things_in_block, std::min(count, (block + 1) * things_in_block));
  });
}

/// Returns the first index below `count` for which `is_bad` is true, or `count`.
template <typename IsBad>
std::size_t first_bad(std::size_t count, unsigned threads, IsBad is_bad) {
  std::vector<std::size_t> found(count_blocks(count), count);
  for_each_block(count, threads, [&](std::size_t block, std::size_t first, std::size_t end) {
    while (first < end && !is_bad(first)) ++first;
    if (first < end) found[block] = first;
  });
  const auto bad = std::ranges::find_if(found, [&](std::size_t number) { return number < count; });
  return bad == found.end() ? count : *bad;
}

}  // namespace

void validate(const Mesh& mesh, unsigned threads) {
  const std::size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  const std::size_t vertex =
      first_bad(vertices, threads, [&](std::size_t v) { return !mesh.vertices[v].allFinite(); });
  if (vertex < vertices) {
    throw Error(ErrorKind::bad_geometry,
                "vertex " + std::to_string(vertex) + " has a non-finite coordinate");
  }
  const std::size_t triangle = first_bad(triangles, threads, [&](std::size_t t) {
    return std::ranges::any_of(mesh.triangles[t], [&](std::uint32_t v) { return v >= vertices; });
  });
  if (triangle < triangles) {
    const auto& corners = mesh.triangles[triangle];
    const auto missing =
        std::ranges::find_if(corners, [&](std::uint32_t corner) { return corner >= vertices; });
    throw Error(ErrorKind::bad_geometry, "triangle " + std::to_string(triangle) + " has vertex " +
                                             std::to_string(*missing) + ", but there are only " +
                                             std::to_string(vertices));
  }
  std::vector<double> areas(count_blocks(triangles), 0.0);
  for_each_block(triangles, threads, [&](std::size_t block, std::size_t first, std::size_t end) {
    double area = 0.0;
    for (; first < end; ++first) area += area_vector(mesh, mesh.triangles[first]).norm();
    areas[block] = area;
  });
  if (!(std::accumulate(areas.begin(), areas.end(), 0.0) > 0.0)) {
    throw Error(ErrorKind::bad_geometry, "the mesh contains no triangle with a positive area");
  }
}

std::vector<Eigen::Vector3d> triangle_corners(const Mesh& mesh) {
  std::vector<Eigen::Vector3d> corners;
  corners.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) corners.push_back(mesh.vertices[v]);
  }
  return corners;
}

Eigen::AlignedBox3d bounding_box(const Mesh& mesh, unsigned threads) {
  std::vector<Eigen::AlignedBox3d> boxes(count_blocks(mesh.triangles.size()));
  for_each_block(mesh.triangles.size(), threads,
                 [&](std::size_t block, std::size_t first, std::size_t end) {
                   Eigen::AlignedBox3d box;
                   for (; first < end; ++first) {
                     for (const std::uint32_t v : mesh.triangles[first]) {
                       box.extend(mesh.vertices[v]);
                     }
                   }
                   boxes[block] = box;
                 });
  Eigen::AlignedBox3d all;
  for (const Eigen::AlignedBox3d& box : boxes) all.extend(box);
  return all;
}

double surface_area(const Mesh& mesh) {
  double area = 0.0;
  for (const auto& triangle : mesh.triangles) area += area_vector(mesh, triangle).norm();
  return area;
}

void append(Mesh& mesh, const Mesh& addition) {
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), addition.vertices.begin(), addition.vertices.end());
  mesh.triangles.reserve(mesh.triangles.size() + addition.triangles.size());
  for (const auto& [a, b, c] : addition.triangles) {
    mesh.triangles.push_back({a + offset, b + offset, c + offset});
  }
}

void transform(Mesh& mesh, const Eigen::Affine3d& target_from_source) {
  for (Vector3d& vertex : mesh.vertices) vertex = target_from_source * vertex;
  if (target_from_source.linear().determinant() >= 0.0) return;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

SurfaceSamples sample_surface(const Mesh& mesh, std::size_t count, std::uint64_t seed) {
  const double share = surface_area(mesh) / static_cast<double>(count);
  RandomNumbers random(seed);

  SurfaceSamples samples;
  samples.points.reserve(count);
  samples.normals.reserve(count);
  samples.triangles.reserve(count);
  double area_before = 0.0;  // total area of the preceding triangles
  double next_sample = share * random.uniform();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    const Vector3d normal = area_vector(mesh, triangle);
    const double area_after = area_before + normal.norm();
    while (next_sample < area_after && samples.points.size() < count) {
      // Uniform sampling of a triangle: folds the unit square over its diagonal.
      double u = random.uniform(), v = random.uniform();
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      const Vector3d& a = mesh.vertices[triangle[0]];
      const Vector3d point =
          a + u * (mesh.vertices[triangle[1]] - a) + v * (mesh.vertices[triangle[2]] - a);
      samples.points.push_back(point.cast<float>());
      samples.normals.push_back(normal.normalized().cast<float>());
      samples.triangles.push_back(t);
      next_sample = share * (static_cast<double>(samples.points.size()) + random.uniform());
    }
    area_before = area_after;
  }
  return samples;
}

}  // namespace skycap::geometry
