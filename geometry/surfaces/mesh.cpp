#include "geometry/surfaces/mesh.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

Vector3d area_vector(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Vector3d& a = mesh.vertices[triangle[0]];
  return 0.5 * (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a);
}

}  // namespace

void validate(const Mesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!mesh.vertices[v].allFinite()) {
      throw Error(ErrorKind::bad_geometry,
                  "vertex " + std::to_string(v) + " has a coordinate that is not a finite number");
    }
  }
  double area = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= mesh.vertices.size()) {
        throw Error(ErrorKind::bad_geometry, "triangle " + std::to_string(t) + " names vertex " +
                                                 std::to_string(v) + ", but there are only " +
                                                 std::to_string(mesh.vertices.size()));
      }
    }
    area += area_vector(mesh, mesh.triangles[t]).norm();
  }
  if (!(area > 0.0)) {
    throw Error(ErrorKind::bad_geometry, "there is no triangle with a positive area");
  }
}

Eigen::AlignedBox3d bounding_box(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) box.extend(mesh.vertices[v]);
  }
  return box;
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
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);

  SurfaceSamples samples;
  samples.points.reserve(count);
  samples.normals.reserve(count);
  samples.triangles.reserve(count);
  double area_before = 0.0;  // of the triangles passed so far
  double next_sample = share * uniform(random);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    const Vector3d normal = area_vector(mesh, triangle);
    const double area_after = area_before + normal.norm();
    while (next_sample < area_after && samples.points.size() < count) {
      // Uniform in the triangle: fold the unit square over its diagonal.
      double u = uniform(random), v = uniform(random);
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      const Vector3d& a = mesh.vertices[triangle[0]];
      const Vector3d point =
          a + u * (mesh.vertices[triangle[1]] - a) + v * (mesh.vertices[triangle[2]] - a);
      samples.points.push_back(point.cast<float>());
      samples.normals.push_back(normal.normalized().cast<float>());
      samples.triangles.push_back(t);
      next_sample = share * (static_cast<double>(samples.points.size()) + uniform(random));
    }
    area_before = area_after;
  }
  return samples;
}

}  // namespace skycap::geometry
