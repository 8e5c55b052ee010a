/// Triangle meshes: the truth that the simulator measures and the evaluation compares with.
/// Planners never include this header.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skycap::geometry {

/// Vertices and the triangles between them, counter-clockwise seen from outside. Plain data: it
/// need not be closed, connected or consistently oriented.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Throws Error{bad_geometry} if a mesh has no triangle of positive area, a triangle names a vertex
/// that does not exist, or a coordinate is not finite; the message says which is the first.
void validate(const Mesh& mesh, unsigned threads = 1);

/// The smallest axis-aligned box around the vertices that triangles use.
Eigen::AlignedBox3d bounding_box(const Mesh& mesh, unsigned threads = 1);

double surface_area(const Mesh& mesh);

/// Adds `addition` to `mesh` as further vertices and triangles.
void append(Mesh& mesh, const Mesh& addition);

/// Moves every vertex; a reflection also turns the triangles round, so that they stay outward.
void transform(Mesh& mesh, const Eigen::Affine3d& target_from_source);

/// Points spread over the surface with equal probability for equal area, and the triangle of each.
struct SurfaceSamples {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< unit, by the triangles' orientation
  std::vector<std::uint32_t> triangles;
};

/// `count` stratified area-uniform samples: one from each of `count` equal shares of the area,
/// which keeps the density even. The same seed gives the same samples.
SurfaceSamples sample_surface(const Mesh& mesh, std::size_t count, std::uint64_t seed);

}  // namespace skycap::geometry
