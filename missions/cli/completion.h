/// Scripts that complete commands and options in a shell.
#pragma once

#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace skycap::missions::cli {

/// The script for "bash", "zsh" or "fish", made from the commands and options of `app`.
std::string completion_script(const CLI::App& app, const std::string& shell);

}  // namespace skycap::missions::cli
