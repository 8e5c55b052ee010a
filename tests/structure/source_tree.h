/// Include graph of the project's sources, for the architecture tests.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace skycap::structure {

/// A source file and its includes.
struct SourceFile {
  std::string path;                   ///< relative to the root, such as "flight/route/route.h"
  std::vector<std::string> own;       ///< included in quotes, relative to the root
  std::vector<std::string> packages;  ///< included in angle brackets, such as "CGAL/Kd_tree.h"

  bool is_header() const { return path.ends_with(".h"); }
  /// Returns the folder of the source, such as "flight/route".
  std::string module_name() const { return std::filesystem::path(path).parent_path().string(); }
};

/// Returns all .h and .cpp files below `folders` of `root`, sorted by path.
std::vector<SourceFile> read_sources(const std::filesystem::path& root,
                                     const std::vector<std::string>& folders);

/// Modules that a module may include in addition to itself.
using Modules = std::map<std::string, std::vector<std::string>>;

/// Returns one line for each include that `modules` does not allow, and for each file outside all
/// modules.
std::vector<std::string> forbidden_includes(const std::vector<SourceFile>& sources,
                                            const Modules& modules);

/// Returns the modules that are part of a cycle in `modules`.
std::vector<std::string> circular_modules(const Modules& modules);

/// Returns the headers that include themselves through other headers.
std::vector<std::string> circular_headers(const std::vector<SourceFile>& sources);

/// Returns one line for each header that includes a package reserved for source files.
std::vector<std::string> heavy_headers(const std::vector<SourceFile>& sources,
                                       const std::vector<std::string>& heavy_packages);

}  // namespace skycap::structure
