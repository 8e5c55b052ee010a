#include "missions/batch/campaign/prepared_scenes.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "geometry/io/file.h"
#include "geometry/parallel.h"
#include "missions/simulation/feasibility.h"
#include "missions/support/number_text.h"

namespace skycap::missions::batch {

namespace {

/// What an earlier task has kept: the attainable coverage or "-", a line end, and a digit for each
/// sample. Nothing if it is not whole.
std::optional<batch::SceneTruth> kept_truth(const std::filesystem::path& file,
                                            std::size_t samples) {
  std::error_code ignored;
  if (file.empty() || !std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  const std::string text = geometry::read_file(file);
  const std::size_t line = std::min(text.size(), text.find('\n'));
  batch::SceneTruth truth;
  if (text.substr(0, line) != "-") {
    double ceiling = -1.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + line, ceiling);
    if (error != std::errc() || end != text.data() + line || !(ceiling >= 0.0 && ceiling <= 1.0)) {
      return std::nullopt;
    }
    truth.ceiling = ceiling;
  }
  if (text.size() != line + 1 + samples) return std::nullopt;
  for (const char digit : text.substr(line + 1)) {
    if (digit != '0' && digit != '1') return std::nullopt;
    truth.is_visible.push_back(digit == '1' ? 1 : 0);
  }
  return truth;
}

void keep_truth(const std::filesystem::path& file, const batch::SceneTruth& truth) {
  if (file.empty()) return;
  std::string text = (truth.ceiling ? support::exact_text(*truth.ceiling) : "-") + "\n";
  for (const std::uint8_t mark : truth.is_visible) text += mark != 0 ? '1' : '0';
  geometry::write_file(file, text);
}

/// What else takes seconds has been done before, if a truth was kept.
batch::SceneTruth truth_of(const Setup& setup, const evaluation::SurveyScene& scene,
                           unsigned threads, const std::stop_token& stop) {
  if (auto kept = kept_truth(setup.truth_file, scene.samples().points.size())) return *kept;
  simulation::require_feasible(setup.mission.simulation, scene, {setup.mission.run.seed, threads});
  batch::SceneTruth truth = batch::scene_truth(scene, threads, stop);
  if (!stop.stop_requested()) keep_truth(setup.truth_file, truth);
  return truth;
}

}  // namespace

PreparedScenes::PreparedScenes(const std::map<std::string, std::size_t>& uses, unsigned threads) {
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
      std::filesystem::path reached = setup.truth_file;
      if (!reached.empty()) reached += "_reached";
      evaluation::SurveyScene scene(setup.mission.simulation, setup.folder(), threads_, reached);
      batch::SceneTruth truth = truth_of(setup, scene, threads_, stop);
      if (stop.stop_requested()) return nullptr;  // the truth is of no use
      slot.scene.reset(new PreparedScene{std::move(scene), std::move(truth)});
    } catch (const Error& error) {
      slot.failure.emplace(error.kind(), setup.file.string() + ": " + error.what());
      throw Error(*slot.failure);
    }
  }
  return --slot.uses > 0 ? slot.scene : std::exchange(slot.scene, nullptr);
}

}  // namespace skycap::missions::batch
