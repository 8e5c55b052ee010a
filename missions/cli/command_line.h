#pragma once

#include <string>
#include <vector>

#include "missions/cli/console.h"

namespace skycap::missions::cli {

/// Runs the program with the given arguments, without the program name. Returns the exit code: 0
/// success, 1 negative result, 2 invalid usage or input, 3 internal error. For 2 and 3, exactly one
/// line, "skycap: error: ...", is written to console.err.
int run_command_line(const std::vector<std::string>& arguments, const Console& console);

}  // namespace skycap::missions::cli
