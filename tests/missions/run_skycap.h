/// Runs the program in the test's process.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stop_token>
#include <string>
#include <vector>

#include "missions/cli/command_line.h"
#include "tests/support/temporary_folder.h"

namespace skycap::tests {

struct ProgramRun {
  int exit_code = 0;
  std::string out, err;
};

inline ProgramRun run_skycap(const std::vector<std::string>& arguments,
                             bool err_is_terminal = false, std::stop_token stop = {}) {
  std::ostringstream out, err;
  const missions::cli::Console console{out, err, err_is_terminal, std::move(stop)};
  const int exit_code = missions::cli::run_command_line(arguments, console);
  return {exit_code, out.str(), err.str()};
}

/// Temporary folder with paths as strings, as on a command line.
class TestFolder {
 public:
  const std::filesystem::path& path() const { return folder_.path(); }
  std::string operator/(const std::string& name) const { return (path() / name).string(); }

  /// Writes a file into the folder and returns its path.
  std::string write(const std::string& name, const std::string& content) const {
    return folder_.file(name, content).string();
  }

 private:
  testing_support::TemporaryFolder folder_;
};

inline std::string read_content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

/// Returns a survey of a teapot that takes 0.1 s, with a coarse sensor and low densities. The noise
/// is of the order of the resolution radius, so that there are frontiers.
inline std::string quick_mission(const std::string& more = "") {
  return "scene: {model: 'builtin:teapot', longest_side: 1.0}\n"
         "sensor: {width: 160, height: 100, noise: {sigma: 0.03}}\n"
         "planner: {density: 5200, resolution_radius: 0.0525, occluder_spacing: 0.03}\n"
         "evaluation: {coverage_distance: 0.03, samples: 3000, visible_directions: 30,\n"
         "             attainable_views: 0}\n"
         "limits: {max_views: 40}\n" +
         more;
}

}  // namespace skycap::tests
