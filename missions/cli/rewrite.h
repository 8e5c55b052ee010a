/// Rewrites missions with current key and value names.
#pragma once

#include <filesystem>

#include "missions/cli/console.h"

namespace skycap::missions::cli {

/// Writes a mission file with current key and value names to `out` and prints the replacements.
/// Comments and layout are preserved. Returns exit code 0. Throws Error{bad_config} if the mission
/// is invalid, and the errors of config::with_current_names().
int rewrite(const std::filesystem::path& mission, const std::filesystem::path& out,
            const Console& console);

}  // namespace skycap::missions::cli
