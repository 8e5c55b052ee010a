/// Base of the examples in these folders. Each example shows the use of one public header, has its
/// name, and checks its own result.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

class Example {
 public:
  using Holds = bool (*)();
  struct Named {
    const char* name;
    Holds holds;
  };

  Example(const char* name, Holds holds) { all().push_back({name, holds}); }

  static std::vector<Named>& all() {
    static std::vector<Named> examples;
    return examples;
  }
};

/// Returns the path for a file that an example writes.
inline std::filesystem::path scratch(const std::string& name) {
  return std::filesystem::current_path() / ("example_" + name);
}
