/// Options of version 0.1 that version 0.2 still accepts. They will be removed in 0.3.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "missions/cli/console.h"
#include "missions/config/key_override.h"

namespace skycap::missions::cli {

/// Replaces former options in the program's arguments, with a warning for each replacement.
std::vector<std::string> with_current_options(std::vector<std::string> arguments,
                                              const Console& console);

/// Prints a one-line warning for each file or override that contains names of version 0.1. The
/// files are missions, campaigns or districts. Unreadable files are ignored here, because the
/// command that reads them reports the error.
void warn_deprecated_names(std::span<const std::filesystem::path> files,
                           std::span<const config::KeyOverride> overrides, const Console& console);

}  // namespace skycap::missions::cli
