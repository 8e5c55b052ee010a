#include "missions/benchmark/trial_files.h"

#include <algorithm>
#include <mutex>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/parallel.h"
#include "missions/derived/survey_settings.h"
#include "missions/file/json_text.h"
#include "missions/scene/sha256.h"
#include "missions/version.h"

namespace skycap::missions::benchmark {

using Json = nlohmann::ordered_json;

std::string trial_fingerprint(const file::Mission& mission, const std::string& contestant) {
  std::string inputs = std::string(version) + "\n" + contestant;
  for (const auto& [key, value] : derived::survey_settings(mission)) {
    inputs.append("\n").append(key).append(" ").append(value);
  }
  return scene::sha256(std::as_bytes(std::span(inputs)));
}

std::optional<Trial> finished_trial(const std::filesystem::path& file,
                                    const std::string& fingerprint) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  try {
    const Json json = geometry::parse_json<Json>(geometry::read_file(file));
    if (json.at("fingerprint") != fingerprint) return std::nullopt;
    return parse_trial(json.at("trial").dump());
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // not ours: it is overwritten
  } catch (const Error&) {
    return std::nullopt;
  }
}

void write_trial(const std::filesystem::path& file, const std::string& fingerprint,
                 const Trial& trial) {
  geometry::write_file(file, file::json_text({{"fingerprint", fingerprint},
                                              {"trial", Json::parse(trial_json(trial))}}));
}

std::vector<Trial> run_trials(const file::Mission& mission, const scene::SurveyScene& scene,
                              std::size_t count, unsigned threads,
                              const std::filesystem::path& folder, std::stop_token stop,
                              const std::function<void(const Trial&)>& report) {
  const std::string fingerprint = trial_fingerprint(mission, "plan");
  const auto file_of = [&](std::size_t i) {
    return folder / ("seed_" + std::to_string(mission.seed + i) + ".json");
  };
  std::vector<std::optional<Trial>> slots(count);
  for (std::size_t i = 0; i < count; ++i) slots[i] = finished_trial(file_of(i), fingerprint);
  const bool is_over =
      std::ranges::all_of(slots, [](const auto& slot) { return slot.has_value(); });
  const SceneTruth truth = is_over ? SceneTruth{} : scene_truth(scene, threads, stop);
  std::mutex reporting;
  geometry::parallel_for(count, threads, [&](std::size_t i) {
    if (slots[i] || stop.stop_requested()) return;
    slots[i] = run_trial(mission, scene, truth, mission.seed + i, stop);
    if (!slots[i]) return;
    write_trial(file_of(i), fingerprint, *slots[i]);
    if (!report) return;
    const std::lock_guard lock(reporting);
    report(*slots[i]);
  });
  std::vector<Trial> trials;
  for (std::optional<Trial>& trial : slots) {
    if (trial) trials.push_back(std::move(*trial));
  }
  return trials;
}

}  // namespace skycap::missions::benchmark
