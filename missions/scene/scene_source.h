/// From the `scene` of a mission to the mesh that is surveyed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/surfaces/mesh.h"
#include "missions/scene/scene_options.h"
#include "sim/scene/scene.h"

namespace skycap::missions::scene {

/// The mesh that `scene` names, in its own frame: builtin:NAME, model:NAME, or the path of a mesh
/// or of any file of prior data that holds surfaces, relative to `folder`; of tiles
/// (scene_tiles.h), all as one mesh. Throws Error{bad_file}, {bad_config} or {bad_geometry}, naming
/// the model, if it is not there, cannot be read, is not a mesh with a surface, or if tiles have
/// more triangles than a single mesh may.
geometry::Mesh load_model(const SceneOptions& scene, const std::filesystem::path& folder);

/// What the triangles of load_model() do to light; empty if all are matt. Throws the same.
std::vector<sim::Surface> load_surfaces(const SceneOptions& scene,
                                        const std::filesystem::path& folder);

/// The files that a scanner (a preset's name, or the path of a description) and the scene are read
/// from, prior data aside. Throws Error{bad_file} for a model:NAME that is nowhere.
std::vector<std::filesystem::path> files_of(const SceneOptions& scene,
                                            const std::optional<std::string>& lidar,
                                            const std::filesystem::path& folder);

/// What turns a model upright and as `scene` says, and scales it: all but its place and what
/// depends on its size.
Eigen::Affine3d turn_and_scale(const SceneOptions& scene);

/// Turns, scales and places a model as `scene` says, tiles by their own origin. Throws
/// Error{bad_geometry} if the model has no extent to be scaled by.
void place_model(const SceneOptions& scene, geometry::Mesh& model);

/// world_from_world, from the first of the scene's models, as place_model() leaves it, to each; the
/// first included.
std::vector<Eigen::Isometry3d> copies_of(const SceneOptions& scene);

/// All of the scene's models as one mesh.
geometry::Mesh with_copies(const SceneOptions& scene, const geometry::Mesh& placed_model);

/// What the sensors of a `scene` measure, with what lasers see of its surfaces.
struct ReflectingScene {
  geometry::Mesh model;                ///< the first
  std::vector<float> reflectances;     ///< diffuse, of each of its triangles
  std::vector<sim::Surface> surfaces;  ///< of each of its triangles; empty: all matt
  std::vector<Eigen::Isometry3d> places;
  geometry::Mesh beside;  ///< surroundings_of() it
  std::vector<float> beside_reflectances;

  /// Made ready for rays; copies take no memory to speak of.
  sim::Scene scene(unsigned threads) const;
  /// Of the models' bounding box.
  Eigen::Vector3d centre() const;
  /// Tells it from other scenes: checksums of all of its parts.
  std::string digest() const;
};

/// The model as placed, its copies, and what is beside it, with the reflectances of `scene`. Throws
/// what load_model() and place_model() throw, and Error{bad_config} if the file of materials is
/// wrong.
ReflectingScene reflecting_scene(const SceneOptions& scene, const std::filesystem::path& folder);

/// The ground that the sensor sees: the terrain of the mission's prior data, else ground_under().
/// The box is that around the placed model.
geometry::Mesh ground_of(const SceneOptions& scene, const Eigen::AlignedBox3d& model);

/// What the sensor sees beside the model, which the box is around: the ground and neighbours, as
/// far as the scene asks for them. Without triangles if it asks for neither.
geometry::Mesh surroundings_of(const SceneOptions& scene, const Eigen::AlignedBox3d& model);

/// A square in the plane of the scene's base, ten times as wide as the model, which the box is
/// around.
geometry::Mesh ground_under(const Eigen::AlignedBox3d& model);

}  // namespace skycap::missions::scene
