#include "missions/batch/campaign/survey_item.h"

#include <algorithm>
#include <utility>

#include "missions/batch/benchmark/trial_files.h"
#include "missions/config/mission_keys.h"
#include "missions/config/resolve.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::batch {

std::string fingerprint_of(const Setup& setup) {
  return batch::trial_fingerprint(setup.mission, setup.contestant->name, setup.folder());
}

Setup own_setup(const std::filesystem::path& file, const config::MissionSetup& mission) {
  Setup setup{file, mission.name, nullptr, mission, ""};
  setup.contestant = batch::find_contestant(survey::title_of(mission.survey().planner.name).word);
  setup.fingerprint = fingerprint_of(setup);
  return setup;
}

Setup read_setup(const std::filesystem::path& file, const batch::Contestant* contestant,
                 const std::string& origin, std::vector<config::KeyOverride> overrides,
                 const config::Report& report) {
  if (!contestant) return own_setup(file, config::read_mission(file, overrides, report));
  const auto& names = config::find_key("planner.name")->choices;
  if (std::ranges::find(names, contestant->name) != names.end()) {
    overrides.push_back({origin, "planner.name", contestant->name});
  }
  Setup setup{file, "", contestant, config::read_mission(file, overrides, report), ""};
  setup.title = setup.mission.name;
  setup.fingerprint = fingerprint_of(setup);
  return setup;
}

}  // namespace skycap::missions::batch
