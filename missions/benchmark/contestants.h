/// What a benchmark can compare. To let something new take part, add it to contestants().
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "missions/benchmark/trials.h"
#include "missions/file/mission.h"
#include "missions/scene/survey_scene.h"

namespace skycap::missions::benchmark {

struct Contestant {
  std::string name;            ///< as on the command line; planner.name if that has it
  std::string title;           ///< as in tables
  bool is_in_all = true;       ///< whether `--planners all` names it
  bool is_volumetric = false;  ///< whether its view limit is the most views that SEE needed

  /// Surveys a mission in one thread; nothing if it was interrupted. The start and the sensor's
  /// noise must follow from the seed alone. Called from several threads.
  std::function<std::optional<Trial>(const file::Mission&, const scene::SurveyScene&,
                                     const SceneTruth&, std::uint64_t seed, std::stop_token)>
      run;
};

/// In the order of the paper's tables, then our own.
const std::vector<Contestant>& contestants();

/// The contestant of that name, or null.
const Contestant* find_contestant(std::string_view name);

}  // namespace skycap::missions::benchmark
