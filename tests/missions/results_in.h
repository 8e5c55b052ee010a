/// Results of a run, for comparison with those of another run.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/missions/run_skycap.h"

namespace skycap::tests {

/// Returns the contents by name, except for files that differ between runs. Of folders it contains
/// the names only.
inline std::map<std::string, std::string> results_in(const std::filesystem::path& folder,
                                                     const std::vector<std::string>& varying) {
  std::map<std::string, std::string> results;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (std::ranges::find(varying, name) != varying.end()) continue;
    results[name] = entry.is_directory() ? "folder" : read_content(entry.path());
  }
  return results;
}

}  // namespace skycap::tests
