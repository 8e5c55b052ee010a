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

std::string SensedScene::digest() const {
  return std::visit([](const auto& scene) -> std::string { return scene.digest(); }, scene_);
}

sim::Scene SensedScene::scene(unsigned threads, const IsWanted& is_wanted) const {
  if (const auto* const tiles = std::get_if<TiledScene>(&scene_)) {
    return tiles->scene(threads, is_wanted);
  }
  return std::get<ReflectingScene>(scene_).scene(threads);
}

}  // namespace skycap::missions::scene
