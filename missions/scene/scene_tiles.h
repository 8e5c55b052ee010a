/// Scenes of many tiles, which a file NAME.tiles in the place of a mesh describes
/// (docs/reference/batch-files.md): mesh files that patterns name, and models that stand there
/// again and again in rows and columns. Such a scene may be larger than memory, since sensors ask
/// for those tiles alone that they can reach.
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

/// A mesh that stands in the scene, once or several times.
struct TileKind {
  SceneOptions scene;  ///< names it
  /// Where its own origin is put, before the whole scene is turned, scaled and placed.
  std::vector<Eigen::Vector3d> shifts;
};

/// Whether the scene is of tiles.
bool is_tiled(const SceneOptions& scene);

/// The tiles of such a scene in the order of its file; files of a pattern by name, models by the
/// seed that they are drawn from, places from south to north and from west to east. Throws Error
/// naming the file if it is not there or wrong, if no file has a name of a pattern, or if a key of
/// `scene` is not for tiles.
std::vector<TileKind> tiles_of(const SceneOptions& scene, const std::filesystem::path& folder);

/// Which parts of a scene are asked for, by boxes around them.
using IsWanted = std::function<bool(const Eigen::AlignedBox3d& box)>;

/// What sensors measure of a scene of tiles. Has looked at each mesh, and keeps none.
class TiledScene {
 public:
  /// Reads all meshes, on so many threads, unless the file `index` says what there is to
  /// know of them; else it will, for whoever asks next. Throws what load_model() throws.
  TiledScene(const SceneOptions& scene, const std::filesystem::path& folder, unsigned threads,
             const std::filesystem::path& index = {});

  /// Of the box around all tiles.
  Eigen::Vector3d centre() const { return box_.center(); }
  /// Tells it from other scenes: checksums of its meshes, and of how they stand.
  const std::string& digest() const { return digest_; }
  std::size_t triangles() const { return triangles_; }

  /// Those tiles that are wanted, and what is beside all tiles, made ready for rays. What a ray
  /// meets of them does not depend on which others are wanted.
  sim::Scene scene(unsigned threads, const IsWanted& is_wanted) const;

 private:
  struct Kind {
    TileKind tile;
    Eigen::AlignedBox3d box;  ///< of the mesh, turned and scaled
    std::size_t triangles = 0;
    std::string digest;
  };
  void look_at(Kind& kind) const;
  std::string index_key() const;
  bool read_index(const std::filesystem::path& index);
  void write_index(const std::filesystem::path& index) const;
  geometry::Mesh turned_and_scaled(const TileKind& tile) const;
  std::vector<Eigen::Isometry3d> places_of(const TileKind& tile) const;

  SceneOptions scene_;
  std::filesystem::path folder_;
  geometry::Mesh beside_;  ///< surroundings_of() the tiles
  std::vector<Kind> kinds_;
  Eigen::AlignedBox3d box_;
  std::size_t triangles_ = 0;
  std::string digest_;
};

}  // namespace skycap::missions::scene
