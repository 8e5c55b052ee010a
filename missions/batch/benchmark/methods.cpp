#include "missions/batch/benchmark/methods.h"

#include <algorithm>
#include <deque>
#include <mutex>
#include <utility>

#include "geometry/error.h"
#include "missions/config/former_names.h"
#include "missions/simulation/omniscient.h"
#include "missions/simulation/survey_runner.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::batch {
namespace {

session::SurveyRecord run_alone(const evaluation::SimulationOptions& options,
                                const evaluation::SurveyScene& scene, std::uint64_t seed,
                                std::stop_token stop) {
  return simulation::run_survey(options, scene, seed, 1, std::move(stop));
}

/// Creates a contestant for a planner supported by planner.name.
Method make_method(const survey::PlannerTitle& planner) {
  using enum survey::PlannerName;
  const bool is_volumetric = planner.metric.has_value();
  return {.name = std::string(planner.word),
          .title = std::string(planner.title),
          .is_in_all = is_volumetric || planner.name == see || planner.name == see_plus_plus,
          .is_volumetric = is_volumetric,
          .has_view_limit = is_volumetric || survey::is_pb_nbv(planner.name),
          .has_fixed_views = survey::has_fixed_views(planner.name),
          .survey = run_alone};
}

/// Contestants of users. Pointers to them stay valid.
class OwnMethods {
 public:
  /// Returns the contestant of a file, which is added if it is new. Throws Error{bad_usage}.
  const Method* add(const std::string& name) {
    const std::filesystem::path file = std::filesystem::absolute(name);
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
      throw Error(ErrorKind::bad_usage, "cannot open the planner " + name);
    }
    const std::string stem = file.stem();
    const Method* known = batch::find_method(stem);
    if (known != nullptr && known->file == file) return known;
    if (known != nullptr || stem == "all") {
      throw Error(ErrorKind::bad_usage, "the planner " + name +
                                            " has the name of another planner (" + stem +
                                            "); rename the file");
    }
    const std::lock_guard lock(mutex_);
    return &methods_.emplace_back(
        Method{.name = stem, .title = stem, .is_in_all = false, .file = file, .survey = run_alone});
  }

  const Method* find(std::string_view name) {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(methods_, name, &Method::name);
    return found == methods_.end() ? nullptr : &*found;
  }

 private:
  std::mutex mutex_;
  std::deque<Method> methods_;
};

OwnMethods& own_methods() {
  static OwnMethods all;
  return all;
}

bool is_file(std::string_view name) { return name.ends_with(".so") || name.ends_with(".py"); }

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
    if (is_file(name)) {
      const Method* const own = own_methods().add(name);
      if (std::ranges::find(chosen, own) == chosen.end()) chosen.push_back(own);
      continue;
    }
    if (name == "all" || find_method(name)) continue;
    throw Error(ErrorKind::bad_usage, "unknown planner '" + name +
                                          "'; expected all or names from " + known +
                                          ", or a custom planner file (.so, .py)");
  }
  return chosen;
}

const Method* find_method(std::string_view name) {
  const auto found = std::ranges::find(methods(), config::current_planner(name), &Method::name);
  return found == methods().end() ? own_methods().find(name) : &*found;
}

std::string to_title(const std::string& name) {
  const Method* method = find_method(name);
  return method != nullptr ? method->title : name;
}

}  // namespace skycap::missions::batch
