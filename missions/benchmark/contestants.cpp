#include "missions/benchmark/contestants.h"

#include <algorithm>
#include <utility>

#include "missions/file/planner_titles.h"
#include "missions/run/omniscient.h"

namespace skycap::missions::benchmark {
namespace {

/// A planner that planner.name knows.
Contestant contestant_of(const file::PlannerTitle& planner) {
  return {.name = std::string(planner.word),
          .title = std::string(planner.title),
          .is_in_all = planner.name != file::PlannerName::skycap,  // not of the paper
          .is_volumetric = planner.metric.has_value(),
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
  static const std::vector<Contestant> all = [] {
    std::vector<Contestant> list;
    for (const file::PlannerTitle& planner : file::planner_titles) {
      list.push_back(contestant_of(planner));
    }
    std::ranges::stable_partition(list, &Contestant::is_in_all);
    list.push_back(omniscient());
    return list;
  }();
  return all;
}

const Contestant* find_contestant(std::string_view name) {
  const auto found = std::ranges::find(contestants(), name, &Contestant::name);
  return found == contestants().end() ? nullptr : &*found;
}

}  // namespace skycap::missions::benchmark
