/// Planners that a benchmark can compare: those of planner.name, the oracle and planners of users.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_record.h"

namespace skycap::missions::batch {

struct Method {
  std::string name;   ///< name on the command line; equal to planner.name if that key supports it
  std::string title;  ///< title in tables
  bool is_in_all = true;  ///< whether `--planners all` includes it
  /// Whether its view limit is the maximum number of views used by SEE.
  bool is_volumetric = false;
  bool has_view_limit = false;  ///< whether its surveys usually end at their number of views
  /// Whether it takes fixed views, which a benchmark runs with several numbers of views.
  bool has_fixed_views = false;
  /// Absolute path of a user's planner; empty for others.
  std::filesystem::path file = {};

  /// Runs a survey of a mission in a single thread. The start and the sensor noise must depend on
  /// the seed only. Called concurrently from several threads.
  std::function<session::SurveyRecord(const evaluation::SimulationOptions&,
                                      const evaluation::SurveyScene&, std::uint64_t seed,
                                      std::stop_token)>
      survey;
};

/// Returns the contestants in the order of the paper's tables, followed by planners not in the
/// paper.
const std::vector<Method>& methods();

/// Returns the contestants with the given names, in the order of methods(). "all" selects those
/// with is_in_all. A name that ends in .so or .py is the file of a user's planner; its title is the
/// file name without extension. Throws Error{bad_usage} with a list of known names if a name is
/// unknown, and if a user's planner has the name of another one.
std::vector<const Method*> methods_by_name(const std::vector<std::string>& names);

/// Returns the contestant with the given name, or null. Users' planners are known once
/// methods_by_name() has returned them.
const Method* find_method(std::string_view name);

/// Returns the title of a contestant, or the name itself if it is unknown.
std::string to_title(const std::string& name);

}  // namespace skycap::missions::batch
