#include "missions/scene/sensed_scene.h"

#include "missions/config/mission_priors.h"

namespace skycap::missions::scene {
namespace {

std::variant<ReflectingScene, TiledScene> read(const config::Mission& mission,
                                               const std::filesystem::path& folder,
                                               const std::filesystem::path& index) {
  if (!config::is_truth_prior(mission) && is_tiled(mission.scene)) {
    return TiledScene(mission, folder, index);
  }
  return reflecting_scene(mission, folder);
}

}  // namespace

SensedScene::SensedScene(const config::Mission& mission, const std::filesystem::path& folder,
                         const std::filesystem::path& index)
    : scene_(read(mission, folder, index)) {}

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
