/// Loads planners of users from shared libraries and Python files.
#pragma once

#include <string>

#include "survey/external/external_planner.h"
#include "survey/own_planner.h"

namespace skycap::missions::session {

/// Creates the planner in `file`. A shared library (.so) must contain SKYCAP_OWN_PLANNER; it is
/// never unloaded. A Python file (.py) is run by python3 in a process of its own. Throws
/// Error{bad_file} that names the file if it is missing, of another type, or not a planner.
survey::external::LoadedPlanner load_own_planner(const std::string& file,
                                                 const survey::OwnPlannerTask& task);

}  // namespace skycap::missions::session
