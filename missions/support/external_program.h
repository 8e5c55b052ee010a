#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

namespace skycap::missions::support {

/// What became of a program.
struct ProgramResult {
  int exit_code = 0;   ///< 127 if there is no such program, 126 if it cannot be started
  std::string output;  ///< what it wrote to its output and error streams
};

/// Runs a program, found by $PATH, in a folder, with nothing on its input, and waits for its end.
/// No shell is involved. Once `stop` is requested it is sent SIGTERM, again and again until it
/// ends. Throws std::system_error if the machine has no pipes left.
ProgramResult run_external_program(const std::vector<std::string>& command,
                                   const std::filesystem::path& folder,
                                   const std::stop_token& stop = {});

/// Starts a program in the same way and goes on without it, in a session of its own, so that it
/// outlives the terminal; what it writes is dropped. False if there is no such program.
bool start_external_program(const std::vector<std::string>& command);

}  // namespace skycap::missions::support
