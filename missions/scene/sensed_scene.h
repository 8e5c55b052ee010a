/// Scene that sensors measure during a flight: a model with copies, or tiles.
#pragma once

#include <filesystem>
#include <string>
#include <variant>

#include <Eigen/Core>

#include "missions/scene/scene_options.h"
#include "missions/scene/scene_source.h"
#include "missions/scene/scene_tiles.h"
#include "sim/scene/scene.h"

namespace skycap::missions::scene {

class SensedScene {
 public:
  /// `index` is used only for tiles, see TiledScene. Throws all errors of reflecting_scene() and
  /// TiledScene().
  SensedScene(const SceneOptions& scene, const std::filesystem::path& folder, unsigned threads,
              const std::filesystem::path& index = {});

  /// Returns true if scene() loads only the selected parts.
  bool is_tiled() const { return std::holds_alternative<TiledScene>(scene_); }
  /// Returns the centre of the bounding box of all models.
  Eigen::Vector3d centre() const;
  /// Returns a checksum that identifies the scene.
  std::string content_checksum() const;
  /// Returns the whole scene or the selected tiles, prepared for ray casting.
  sim::Scene scene(unsigned threads, const TileFilter& tile_filter) const;

 private:
  std::variant<ReflectingScene, TiledScene> scene_;
};

}  // namespace skycap::missions::scene
