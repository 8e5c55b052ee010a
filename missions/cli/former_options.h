/// Options of version 0.1 that version 0.2 accepts. Removed with 0.3.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "missions/cli/console.h"
#include "missions/config/key_override.h"

namespace skycap::missions::cli {

/// The arguments of the program with current options; warns of each that was replaced.
std::vector<std::string> with_current_options(std::vector<std::string> arguments,
                                              const Console& console);

/// Warns, in one line each, of files and overrides with names of version 0.1. The files are
/// missions, campaigns or districts; what cannot be read is left to who reads it next.
void warn_of_former_names(std::span<const std::filesystem::path> files,
                          std::span<const config::KeyOverride> overrides, const Console& console);

}  // namespace skycap::missions::cli
