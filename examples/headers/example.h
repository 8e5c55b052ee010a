/// What the sources of these folders are: each shows one public header in use, is named after it,
/// and knows what must come out.
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

/// A place for a file that an example writes.
inline std::filesystem::path scratch(const std::string& name) {
  return std::filesystem::current_path() / ("example_" + name);
}
