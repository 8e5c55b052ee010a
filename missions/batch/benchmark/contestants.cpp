#include "missions/batch/benchmark/contestants.h"

#include <algorithm>
#include <utility>

#include "geometry/error.h"
#include "missions/config/former_names.h"
#include "missions/simulation/omniscient.h"
#include "missions/simulation/survey_runner.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::batch {
namespace {

/// Creates a contestant for a planner supported by planner.name.
Contestant contestant_of(const survey::PlannerTitle& planner) {
  return {
      .name = std::string(planner.word),
      .title = std::string(planner.title),
      .is_in_all = planner.name != survey::PlannerName::skycap,  // not in the paper
      .is_volumetric = planner.metric.has_value(),
      .survey = [](const evaluation::SimulationOptions& options,
                   const evaluation::SurveyScene& scene, std::uint64_t seed, std::stop_token stop) {
        return simulation::run_survey(options, scene, seed, 1, std::move(stop));
      }};
}

/// Returns the oracle, a reference planner with access to the scene.
Contestant oracle() {
  const auto survey = [](const evaluation::SimulationOptions& options,
                         const evaluation::SurveyScene& scene, std::uint64_t seed,
                         std::stop_token stop) {
    return simulation::survey_omnisciently(options, scene, seed, 1, {}, std::move(stop));
  };
  return {.name = "oracle", .title = "Oracle", .is_in_all = false, .survey = survey};
}

}  // namespace

const std::vector<Contestant>& contestants() {
  static const std::vector<Contestant> all = [] {
    std::vector<Contestant> list;
    for (const survey::PlannerTitle& planner : survey::planner_titles) {
      list.push_back(contestant_of(planner));
    }
    // std::ranges::stable_partition does not compile with clang 14.
    std::stable_partition(list.begin(), list.end(), std::mem_fn(&Contestant::is_in_all));
    list.push_back(oracle());
    return list;
  }();
  return all;
}

std::vector<const Contestant*> contestants_named(const std::vector<std::string>& names) {
  std::vector<const Contestant*> chosen;
  std::string known;
  const bool has_all = std::ranges::find(names, "all") != names.end();
  for (const Contestant& contestant : contestants()) {
    known += (known.empty() ? "" : ", ") + contestant.name;
    const bool is_named =
        std::ranges::find(names, contestant.name, config::current_planner) != names.end();
    if (is_named || (has_all && contestant.is_in_all)) chosen.push_back(&contestant);
  }
  for (const std::string& name : names) {
    if (name == "all" || find_contestant(name)) continue;
    throw Error(ErrorKind::bad_usage,
                "unknown planner '" + name + "'; expected all or some of " + known);
  }
  return chosen;
}

const Contestant* find_contestant(std::string_view name) {
  const auto found =
      std::ranges::find(contestants(), config::current_planner(name), &Contestant::name);
  return found == contestants().end() ? nullptr : &*found;
}

}  // namespace skycap::missions::batch
