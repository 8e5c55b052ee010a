/// What a benchmark can compare. To let something new take part, add it to contestants().
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_record.h"

namespace skycap::missions::batch {

struct Contestant {
  std::string name;            ///< as on the command line; planner.name if that has it
  std::string title;           ///< as in tables
  bool is_in_all = true;       ///< whether `--planners all` names it
  bool is_volumetric = false;  ///< whether its view limit is the most views that SEE needed

  /// Surveys a mission in one thread. The start and the sensor's noise must follow from the seed
  /// alone. Called from several threads.
  std::function<session::SurveyRecord(const evaluation::SimulationOptions&,
                                      const evaluation::SurveyScene&, std::uint64_t seed,
                                      std::stop_token)>
      survey;
};

/// In the order of the paper's tables, then our own.
const std::vector<Contestant>& contestants();

/// Those of some names, in the same order; "all" stands for those that are in all. Throws
/// Error{bad_usage} with the known ones if there is none of a name.
std::vector<const Contestant*> contestants_named(const std::vector<std::string>& names);

/// The contestant of that name, or null.
const Contestant* find_contestant(std::string_view name);

}  // namespace skycap::missions::batch
