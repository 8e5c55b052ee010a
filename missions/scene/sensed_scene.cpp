#include "missions/scene/sensed_scene.h"

namespace skycap::missions::scene {
namespace {

std::variant<ReflectingScene, TiledScene> read(const SceneOptions& scene,
                                               const std::filesystem::path& folder,
                                               unsigned threads,
                                               const std::filesystem::path& index) {
  if (!scene.is_truth_prior() && is_tiled(scene)) {
    return TiledScene(scene, folder, threads, index);
  }
  return reflecting_scene(scene, folder);
}

}  // namespace

SensedScene::SensedScene(const SceneOptions& scene, const std::filesystem::path& folder,
                         unsigned threads, const std::filesystem::path& index)
    : scene_(read(scene, folder, threads, index)) {}

Eigen::Vector3d SensedScene::centre() const {
  return std::visit([](const auto& scene) -> Eigen::Vector3d { return scene.centre(); }, scene_);
}

std::string SensedScene::content_checksum() const {
  return std::visit([](const auto& scene) -> std::string { return scene.content_checksum(); },
                    scene_);
}

sim::Scene SensedScene::scene(unsigned threads, const TileFilter& tile_filter) const {
  if (const auto* const tiles = std::get_if<TiledScene>(&scene_)) {
    return tiles->scene(threads, tile_filter);
  }
  return std::get<ReflectingScene>(scene_).scene(threads);
}

}  // namespace skycap::missions::scene
