/// Planners of users in Python. Each planner runs in a python3 process of its own: surveys in
/// several threads do not share an interpreter, and a crash ends one survey only.
#pragma once

#include <string>

#include "survey/external/external_planner.h"
#include "survey/own_planner.h"

namespace skycap::missions::session {

/// Starts python3 (from $PATH) and creates the planner: the only class of the file with
/// a method next_view. Throws Error{bad_file} that names the file and contains the Python message.
survey::external::LoadedPlanner load_python_planner(const std::string& file,
                                                    const survey::OwnPlannerTask& task);

}  // namespace skycap::missions::session
