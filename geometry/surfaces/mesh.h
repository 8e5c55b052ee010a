/// Triangle meshes: the ground truth for the simulator and the evaluation. Planners never include
/// this header.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skycap::geometry {

/// Vertices [m] and triangles, counter-clockwise seen from outside. The mesh need not be closed,
/// connected or consistently oriented.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Throws Error{bad_geometry} if no triangle has a positive area, a vertex index is out of range,
/// or a coordinate is not finite. The message names the first defect.
void validate(const Mesh& mesh, unsigned threads = 1);

/// Returns the smallest axis-aligned box around the vertices that triangles use.
Eigen::AlignedBox3d bounding_box(const Mesh& mesh, unsigned threads = 1);
/// Returns the three vertices of each triangle. Shared vertices are repeated.
std::vector<Eigen::Vector3d> triangle_corners(const Mesh& mesh);

double surface_area(const Mesh& mesh);

/// Appends the vertices and triangles of `addition` to `mesh`.
void append(Mesh& mesh, const Mesh& addition);

/// Transforms every vertex. After a reflection, the triangles are reversed, so that they still face
/// outward.
void transform(Mesh& mesh, const Eigen::Affine3d& target_from_source);

/// Points distributed uniformly over the surface area, with their triangles.
struct SurfaceSamples {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< unit vectors, by triangle orientation
  std::vector<std::uint32_t> triangles;
};

/// Returns `count` stratified area-uniform samples. One sample is drawn from each of `count` equal
/// parts of the area, which makes the density even. The result depends only on `mesh`, `count` and
/// `seed`.
SurfaceSamples sample_surface(const Mesh& mesh, std::size_t count, std::uint64_t seed);

}  // namespace skycap::geometry
