/// Ray-casting data of Scene. Internal to this library's sources.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/scene/ray_kernels.h"
#include "sim/scene/ray_tree.h"
#include "sim/scene/scene.h"

namespace skycap::sim {

struct Scene::Trees {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< World position of the origin for rays [m].
  RayTarget target;                                  ///< Target of rays, relative to `centre`.

  std::vector<RayTree> parts;
  /// Tree over the copies. Empty for a scene with a single mesh.
  std::vector<RayTree> over_copies;
  std::vector<SceneCopy> copies;
  /// For each copy, index of its first triangle among those of all parts.
  std::vector<std::uint32_t> own_triangles;
  std::vector<Surface> surfaces;  ///< Surfaces of the triangles of each part. Empty: all matt.

  /// Returns the index, among the triangles of all parts without copies, of a hit triangle.
  std::size_t own_triangle(std::uint32_t triangle) const;
  /// Returns the surface of a hit triangle.
  Surface surface(std::uint32_t triangle) const {
    return surfaces.empty() ? Surface::matt : surfaces[own_triangle(triangle)];
  }
};

/// Builds the trees of a single valid mesh.
std::unique_ptr<Scene::Trees> grow_tree(const geometry::Mesh& mesh, unsigned threads);

/// Returns a box around all copies of all parts.
Eigen::AlignedBox3d box_around(std::span<const ScenePart> parts);

/// Throws Error{bad_geometry} unless `count` is the number of triangles. `what` is the name of the
/// property.
void require_one_each(std::size_t count, const char* what, const geometry::Mesh& mesh);

/// Throws the same errors as geometry::validate(), and Error{bad_geometry} if a property does not
/// have one value per triangle.
void require_valid(const ScenePart& part, unsigned threads);

}  // namespace skycap::sim
