#include "missions/campaign/survey_item.h"

#include <algorithm>
#include <utility>

#include "missions/benchmark/trial_files.h"
#include "missions/derived/resolved_mission.h"
#include "missions/file/mission_keys.h"
#include "missions/file/planner_titles.h"

namespace skycap::missions::campaign {

std::string fingerprint_of(const Setup& setup) {
  return benchmark::trial_fingerprint(setup.mission, setup.contestant->name, setup.folder());
}

Setup own_setup(const std::filesystem::path& file, const file::Mission& mission) {
  Setup setup{file, mission.name, nullptr, mission, ""};
  setup.contestant = benchmark::find_contestant(file::title_of(mission.planner.name).word);
  setup.fingerprint = fingerprint_of(setup);
  return setup;
}

Setup read_setup(const std::filesystem::path& file, const benchmark::Contestant* contestant,
                 const std::string& origin, std::vector<file::KeyOverride> overrides,
                 const derived::Report& report) {
  if (!contestant) return own_setup(file, derived::read_mission(file, overrides, report));
  const auto& names = file::find_key("planner.name")->choices;
  if (std::ranges::find(names, contestant->name) != names.end()) {
    overrides.push_back({origin, "planner.name", contestant->name});
  }
  Setup setup{file, "", contestant, derived::read_mission(file, overrides, report), ""};
  setup.title = setup.mission.name;
  setup.fingerprint = fingerprint_of(setup);
  return setup;
}

}  // namespace skycap::missions::campaign
