/// Shell completion scripts for commands and options.
#pragma once

#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace skycap::missions::cli {

/// Returns the completion script for `shell` ("bash", "zsh" or "fish"), generated from the commands
/// and options of `app`.
std::string completion_script(const CLI::App& app, const std::string& shell);

}  // namespace skycap::missions::cli
