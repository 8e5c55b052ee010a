/// Scenes that consist of many tiles, described by a file NAME.tiles instead of a mesh
/// (docs/reference/batch-files.md). Tiles are mesh files that match patterns, and models repeated
/// in rows and columns. Such a scene may be larger than memory, because only the tiles within a
/// sensor's range are loaded.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/surfaces/mesh.h"
#include "missions/scene/scene_options.h"
#include "sim/scene/scene.h"

namespace skycap::missions::scene {

/// Mesh with one or more instances in the scene.
struct TileKind {
  SceneOptions scene;  ///< Source of the mesh.
  /// Positions of the mesh's own origin before the whole scene is rotated, scaled and moved.
  std::vector<Eigen::Vector3d> shifts;
};

/// Returns true if the scene consists of tiles.
bool is_tiled(const SceneOptions& scene);

/// Returns the tiles of a scene in file order: files of a pattern by name, models by seed,
/// positions from south to north and from west to east. Throws Error naming the file if it is
/// missing or invalid or a pattern matches no file. Throws Error also if a key of `scene` does not
/// apply to tiles.
std::vector<TileKind> find_tiles(const SceneOptions& scene, const std::filesystem::path& folder);

/// Selects parts of a scene by their bounding boxes.
using TileFilter = std::function<bool(const Eigen::AlignedBox3d& box)>;

/// Scene of tiles. It stores the properties of each mesh, but not the meshes.
class TiledScene {
 public:
  /// Reads all meshes with `threads` threads, unless the file `index` contains their properties.
  /// Otherwise writes this file for later runs. Throws all errors of load_model().
  TiledScene(const SceneOptions& scene, const std::filesystem::path& folder, unsigned threads,
             const std::filesystem::path& index = {});

  /// Returns the centre of the bounding box of all tiles.
  Eigen::Vector3d centre() const { return box_.center(); }
  /// Returns a checksum of the meshes and their arrangement, which identifies the scene.
  const std::string& content_checksum() const { return content_checksum_; }
  std::size_t triangles() const { return triangles_; }

  /// Returns the selected tiles and the surroundings of all tiles, prepared for ray casting. Hits
  /// on a tile do not depend on the selection of other tiles.
  sim::Scene scene(unsigned threads, const TileFilter& tile_filter) const;

 private:
  struct Kind {
    TileKind tile;
    Eigen::AlignedBox3d box;  ///< Bounding box of the rotated and scaled mesh.
    std::size_t triangles = 0;
    std::string content_checksum;
  };
  void look_at(Kind& kind) const;
  std::string index_key() const;
  bool read_index(const std::filesystem::path& index);
  void write_index(const std::filesystem::path& index) const;
  geometry::Mesh turned_and_scaled(const TileKind& tile) const;
  std::vector<Eigen::Isometry3d> copy_poses(const TileKind& tile) const;

  SceneOptions scene_;
  std::filesystem::path folder_;
  geometry::Mesh surroundings_;  ///< Result of make_surroundings() for the tiles.
  std::vector<Kind> kinds_;
  Eigen::AlignedBox3d box_;
  std::size_t triangles_ = 0;
  std::string content_checksum_;
};

}  // namespace skycap::missions::scene
