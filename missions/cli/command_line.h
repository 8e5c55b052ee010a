#pragma once

#include <string>
#include <vector>

#include "missions/cli/console.h"

namespace skycap::missions::cli {

/// Runs the program with these arguments (without its own name). Returns the exit code: 0 done,
/// 1 the answer is "no", 2 bad usage or input, 3 an internal failure. For 2 and 3 exactly one line,
/// "skycap: error: ...", goes to console.err.
int run_command_line(const std::vector<std::string>& arguments, const Console& console);

}  // namespace skycap::missions::cli
