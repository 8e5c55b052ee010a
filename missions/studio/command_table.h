/// Commands that the page may run, with their options. The page sends names and values; the
/// program's command line is made here, without a shell.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "missions/studio/work_folder.h"

namespace skycap::missions::studio {

/// Values by option name, such as "--out"; positional arguments by their name, such as "mission".
using OptionValues = std::map<std::string, std::vector<std::string>>;

/// Returns the arguments of the program for a command. Files must be in the work folder and remain
/// relative to it. Throws Error{bad_usage} for an unknown command or option, a missing positional
/// argument, and a path outside of the work folder.
std::vector<std::string> make_arguments(const std::string& command, const OptionValues& values,
                                        const WorkFolder& folder);

/// Returns the command line for a POSIX shell.
std::string shell_text(const std::vector<std::string>& arguments);

}  // namespace skycap::missions::studio
