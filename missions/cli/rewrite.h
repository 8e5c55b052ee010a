/// Writes missions with current names.
#pragma once

#include <filesystem>

#include "missions/cli/console.h"

namespace skycap::missions::cli {

/// Writes the text of a mission file with the current names of keys and values to `out`, comments
/// and layout kept, and prints which names it replaced. Returns exit code 0. Throws
/// Error{bad_config} for a mission that is not right, or that config::with_current_names() refuses.
int rewrite(const std::filesystem::path& mission, const std::filesystem::path& out,
            const Console& console);

}  // namespace skycap::missions::cli
