#include "missions/batch/benchmark/methods.h"

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
Method make_method(const survey::PlannerTitle& planner) {
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
Method oracle() {
  const auto survey = [](const evaluation::SimulationOptions& options,
                         const evaluation::SurveyScene& scene, std::uint64_t seed,
                         std::stop_token stop) {
    return simulation::survey_omnisciently(options, scene, seed, 1, {}, std::move(stop));
  };
  return {.name = "oracle", .title = "Oracle", .is_in_all = false, .survey = survey};
}

}  // namespace

const std::vector<Method>& methods() {
  static const std::vector<Method> all = [] {
    std::vector<Method> list;
    for (const survey::PlannerTitle& planner : survey::planner_titles) {
      list.push_back(make_method(planner));
    }
    // std::ranges::stable_partition does not compile with clang 14.
    std::stable_partition(list.begin(), list.end(), std::mem_fn(&Method::is_in_all));
    list.push_back(oracle());
    return list;
  }();
  return all;
}

std::vector<const Method*> methods_by_name(const std::vector<std::string>& names) {
  std::vector<const Method*> chosen;
  std::string known;
  const bool has_all = std::ranges::find(names, "all") != names.end();
  for (const Method& method : methods()) {
    known += (known.empty() ? "" : ", ") + method.name;
    const bool is_named =
        std::ranges::find(names, method.name, config::current_planner) != names.end();
    if (is_named || (has_all && method.is_in_all)) chosen.push_back(&method);
  }
  for (const std::string& name : names) {
    if (name == "all" || find_method(name)) continue;
    throw Error(ErrorKind::bad_usage,
                "unknown planner '" + name + "'; expected all or names from " + known);
  }
  return chosen;
}

const Method* find_method(std::string_view name) {
  const auto found = std::ranges::find(methods(), config::current_planner(name), &Method::name);
  return found == methods().end() ? nullptr : &*found;
}

}  // namespace skycap::missions::batch
