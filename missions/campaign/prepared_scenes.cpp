#include "missions/campaign/prepared_scenes.h"

#include <algorithm>
#include <utility>

#include "geometry/parallel.h"
#include "missions/run/feasibility.h"

namespace skycap::missions::campaign {

PreparedScenes::PreparedScenes(std::map<std::string, std::size_t> uses, unsigned threads) {
  for (const auto& [title, count] : uses) slots_[title].uses = count;
  const auto scenes = static_cast<unsigned>(std::max<std::size_t>(1, slots_.size()));
  threads_ = std::max(1U, geometry::thread_count(threads) / scenes);
}

std::shared_ptr<const PreparedScene> PreparedScenes::take(const Setup& setup,
                                                          const std::stop_token& stop,
                                                          const std::function<void()>& preparing) {
  Slot& slot = slots_.at(setup.title);
  const std::lock_guard lock(slot.mutex);
  if (slot.failure) throw Error(*slot.failure);
  if (stop.stop_requested()) return nullptr;
  if (!slot.scene) {
    preparing();
    try {
      scene::SurveyScene scene(setup.mission, setup.folder());
      run::require_feasible(setup.mission, scene, threads_);
      benchmark::SceneTruth truth = benchmark::scene_truth(scene, threads_, stop);
      if (stop.stop_requested()) return nullptr;  // the truth is of no use
      slot.scene.reset(new PreparedScene{std::move(scene), std::move(truth)});
    } catch (const Error& error) {
      slot.failure.emplace(error.kind(), setup.file.string() + ": " + error.what());
      throw Error(*slot.failure);
    }
  }
  return --slot.uses > 0 ? slot.scene : std::exchange(slot.scene, nullptr);
}

}  // namespace skycap::missions::campaign
