#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

namespace skycap::missions::support {

/// Result of an external program.
struct ProgramResult {
  int exit_code = 0;   ///< 127 if the program is not found, 126 if it cannot be started
  std::string output;  ///< contents of its output and error streams
};

/// Runs a program from $PATH in a folder with empty input, and waits for its end. No shell is
/// involved. Once `stop` is requested, SIGTERM is sent repeatedly until the program ends. Throws
/// std::system_error if no pipe can be created.
ProgramResult run_external_program(const std::vector<std::string>& command,
                                   const std::filesystem::path& folder,
                                   const std::stop_token& stop = {});

/// Starts a program from $PATH without waiting for it. It runs in its own session, so that it
/// outlives the terminal; its output is discarded. Returns false if the program is not found.
bool start_external_program(const std::vector<std::string>& command);

}  // namespace skycap::missions::support
