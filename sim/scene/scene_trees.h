/// What Scene hides: the trees that rays walk down. For sources of this folder only.
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
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< world position of the rays' origin
  RayTarget target;                                  ///< at which rays are cast, in that frame

  std::vector<RayTree> parts;
  std::vector<RayTree> over_copies;  ///< one tree, or none: the scene is a single mesh
  std::vector<SceneCopy> copies;
  std::vector<std::uint32_t> own_triangles;  ///< of each copy, the first among those of all parts
  std::vector<Surface> surfaces;             ///< of each part's triangles; empty: all matt

  /// The triangle, among those of all parts without their copies, that a hit is on.
  std::size_t own_triangle(std::uint32_t triangle) const;
  /// Of the triangle that a hit is on.
  Surface surface(std::uint32_t triangle) const {
    return surfaces.empty() ? Surface::matt : surfaces[own_triangle(triangle)];
  }
};

/// Of a single mesh, which is valid.
std::unique_ptr<Scene::Trees> grow_tree(const geometry::Mesh& mesh, unsigned threads);

/// A box around all copies of all parts.
Eigen::AlignedBox3d box_around(std::span<const ScenePart> parts);

/// Throws Error{bad_geometry} if there are so many properties for another number of triangles.
void require_one_each(std::size_t count, const char* what, const geometry::Mesh& mesh);

/// Throws what geometry::validate() throws, and Error{bad_geometry} if a property is not one for
/// each triangle.
void require_valid(const ScenePart& part, unsigned threads);

}  // namespace skycap::sim
