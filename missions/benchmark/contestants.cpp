#include "missions/benchmark/contestants.h"

#include <algorithm>
#include <utility>

#include "missions/run/omniscient.h"

namespace skycap::missions::benchmark {
namespace {

/// A planner that planner.name knows.
Contestant planner(std::string name, std::string title, bool is_volumetric, bool is_in_all = true) {
  return {.name = std::move(name),
          .title = std::move(title),
          .is_in_all = is_in_all,
          .is_volumetric = is_volumetric,
          .run = run_trial};
}

/// The reference that knows the scene.
Contestant omniscient() {
  const auto run = [](const file::Mission& mission, const scene::SurveyScene& scene,
                      const SceneTruth& truth, std::uint64_t seed,
                      std::stop_token stop) -> std::optional<Trial> {
    const run::SurveyRecord record =
        run::survey_omnisciently(mission, scene, seed, 1, {}, std::move(stop));
    if (record.stop_reason == survey::StopReason::interrupted) return std::nullopt;
    return trial_of(record, truth);
  };
  return {.name = "omniscient", .title = "Omniscient", .is_in_all = false, .run = run};
}

}  // namespace

const std::vector<Contestant>& contestants() {
  static const std::vector<Contestant> all{
      planner("see++", "SEE++", false),
      planner("see", "SEE", false),
      planner("rsv", "RSV", true),
      planner("rse", "RSE", true),
      planner("oa", "OA", true),
      planner("uv", "UV", true),
      planner("pc", "PC", true),
      planner("af", "AF", true),
      planner("ae", "AE", true),
      planner("skycap", "Skycap", false, false),  // not of the paper
      omniscient(),
  };
  return all;
}

const Contestant* find_contestant(std::string_view name) {
  const auto found = std::ranges::find(contestants(), name, &Contestant::name);
  return found == contestants().end() ? nullptr : &*found;
}

}  // namespace skycap::missions::benchmark
