/// The project's own sources as a graph of includes, for the tests that guard the house's rooms.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace skycap::structure {

/// A source and what it includes.
struct SourceFile {
  std::string path;                   ///< from the root, such as "flight/route/route.h"
  std::vector<std::string> own;       ///< included in quotes: paths from the root
  std::vector<std::string> packages;  ///< included in angle brackets, such as "CGAL/Kd_tree.h"

  bool is_header() const { return path.ends_with(".h"); }
  /// The folder it stands in, such as "flight/route".
  std::string module_name() const { return std::filesystem::path(path).parent_path().string(); }
};

/// All .h and .cpp files below `folders` of `root`, by path.
std::vector<SourceFile> read_sources(const std::filesystem::path& root,
                                     const std::vector<std::string>& folders);

/// Which rooms a room may include beside itself.
using Modules = std::map<std::string, std::vector<std::string>>;

/// One line for each include that `modules` does not allow, and for each file in no room.
std::vector<std::string> forbidden_includes(const std::vector<SourceFile>& sources,
                                            const Modules& modules);

/// Rooms that can be reached from themselves by the rows of `modules`: none, if all ways go one
/// way.
std::vector<std::string> circular_modules(const Modules& modules);

/// Headers that include themselves by way of others.
std::vector<std::string> circular_headers(const std::vector<SourceFile>& sources);

/// One line for each header that includes a package whose headers are for sources only.
std::vector<std::string> heavy_headers(const std::vector<SourceFile>& sources,
                                       const std::vector<std::string>& heavy_packages);

}  // namespace skycap::structure
