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

/// Of parts whose meshes are valid.
std::unique_ptr<Scene::Trees> grow_trees(std::span<const ScenePart> parts, unsigned threads);

}  // namespace skycap::sim
