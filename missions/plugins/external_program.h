#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace skycap::missions::plugins {

/// What became of a program.
struct ProgramResult {
  int exit_code = 0;   ///< 127 if there is no such program, 126 if it cannot be started
  std::string output;  ///< what it wrote to its output and error streams
};

/// Runs a program, found by $PATH, in a folder, with nothing on its input, and waits for its end.
/// No shell is involved. Throws std::system_error if the machine has no pipes left.
ProgramResult run_external_program(const std::vector<std::string>& command,
                                   const std::filesystem::path& folder);

}  // namespace skycap::missions::plugins
