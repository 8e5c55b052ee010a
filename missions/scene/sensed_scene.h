/// What sensors measure on a flight: a model with its copies, or tiles.
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
  /// `index` is of tiles, see TiledScene. Throws what reflecting_scene() and TiledScene's
  /// constructor throw.
  SensedScene(const SceneOptions& scene, const std::filesystem::path& folder, unsigned threads,
              const std::filesystem::path& index = {});

  /// Whether scene() is of what is wanted alone.
  bool is_tiled() const { return std::holds_alternative<TiledScene>(scene_); }
  /// Of the models' bounding box.
  Eigen::Vector3d centre() const;
  /// Tells it from other scenes.
  std::string digest() const;
  /// Made ready for rays: all of it, or those tiles that are wanted.
  sim::Scene scene(unsigned threads, const IsWanted& is_wanted) const;

 private:
  std::variant<ReflectingScene, TiledScene> scene_;
};

}  // namespace skycap::missions::scene
