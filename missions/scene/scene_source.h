/// Loading of the mesh defined by a mission's `scene`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/surfaces/mesh.h"
#include "missions/scene/scene_options.h"
#include "sim/scene/scene.h"

namespace skycap::missions::scene {

/// Returns the mesh of `scene` in its own frame: builtin:NAME, model:NAME, or the path of a mesh or
/// of a prior data file with surfaces, relative to `folder`. Tiles (scene_tiles.h) are joined to
/// one mesh. Throws Error{bad_file}, {bad_config} or {bad_geometry} naming the model if it does not
/// exist, cannot be read, or is not a mesh with a surface. Tiles must not exceed the triangle limit
/// of a single mesh.
geometry::Mesh load_model(const SceneOptions& scene, const std::filesystem::path& folder);

/// Returns the optical type of each triangle of load_model(); empty if all are matt. Throws like
/// load_model().
std::vector<sim::Surface> load_surfaces(const SceneOptions& scene,
                                        const std::filesystem::path& folder);

/// Returns the input files of a scanner (preset name or path of a description) and of the scene,
/// without prior data. Throws Error{bad_file} for a model:NAME that is not stored.
std::vector<std::filesystem::path> collect_files(const SceneOptions& scene,
                                                 const std::optional<std::string>& lidar,
                                                 const std::filesystem::path& folder);

/// Returns the rotation and scaling of a model defined by `scene`, without its position and without
/// scaling to a size.
Eigen::Affine3d turn_and_scale(const SceneOptions& scene);

/// Rotates, scales and moves a model as defined by `scene`. Tiles are positioned by their own
/// origin. Throws Error{bad_geometry} if the model has no extent or its corners are outside the
/// coordinate range.
void place_model(const SceneOptions& scene, geometry::Mesh& model);

/// Returns the transforms from the first model, as placed by place_model(), to each model, starting
/// with the identity for the first.
std::vector<Eigen::Isometry3d> compute_copy_poses(const SceneOptions& scene);

/// Returns all models of the scene as one mesh.
geometry::Mesh with_copies(const SceneOptions& scene, const geometry::Mesh& placed_model);

/// Scene that sensors measure, with the optical properties of its surfaces.
struct ReflectingScene {
  geometry::Mesh model;                ///< First of the models.
  std::vector<float> reflectances;     ///< Diffuse reflectance of each triangle.
  std::vector<sim::Surface> surfaces;  ///< Optical type of each triangle; empty if all are matt.
  std::vector<Eigen::Isometry3d> poses;
  geometry::Mesh surroundings;  ///< Result of make_surroundings() for all models.
  std::vector<float> surroundings_reflectances;

  /// Returns the scene prepared for ray casting. Copies share the memory of the model.
  sim::Scene scene(unsigned threads) const;
  /// Returns the centre of the bounding box of all models.
  Eigen::Vector3d centre() const;
  /// Returns the checksums of all parts, which identify the scene.
  std::string content_checksum() const;
};

/// Returns the placed model, its copies and its surroundings with the reflectances of `scene`.
/// Throws all errors of load_model() and place_model(), and Error{bad_config} for an invalid
/// materials file.
ReflectingScene reflecting_scene(const SceneOptions& scene, const std::filesystem::path& folder);

/// Returns the ground that sensors measure: the terrain of the mission's prior data, otherwise
/// ground_under(). `model` is the bounding box of the placed model.
geometry::Mesh make_ground(const SceneOptions& scene, const Eigen::AlignedBox3d& model);

/// Returns the surroundings that the scene includes: ground and neighbouring objects. `model` is
/// the bounding box of the placed model. The mesh is empty if neither is enabled.
geometry::Mesh make_surroundings(const SceneOptions& scene, const Eigen::AlignedBox3d& model);

/// Returns a square at the height of the model's base, ten times as wide as the bounding box
/// `model`.
geometry::Mesh ground_under(const Eigen::AlignedBox3d& model);

}  // namespace skycap::missions::scene
