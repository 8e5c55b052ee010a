#include "tests/structure/source_tree.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <set>

namespace skycap::structure {
namespace {

namespace fs = std::filesystem;

/// Returns the text between the delimiters after "#include ". Empty if the line is not an include.
std::string included(const std::string& line, char open, char close) {
  const std::string start = std::string("#include ") + open;
  if (!line.starts_with(start)) return "";
  const std::size_t end = line.find(close, start.size());
  return end == std::string::npos ? "" : line.substr(start.size(), end - start.size());
}

SourceFile read_source(const fs::path& root, const fs::path& file) {
  SourceFile source;
  source.path = fs::relative(file, root).generic_string();
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (const std::string own = included(line, '"', '"'); !own.empty()) source.own.push_back(own);
    if (const std::string package = included(line, '<', '>'); !package.empty()) {
      source.packages.push_back(package);
    }
  }
  return source;
}

using Graph = std::map<std::string, std::vector<std::string>>;

/// Returns the nodes that are part of a cycle.
std::vector<std::string> nodes_on_circles(const Graph& graph) {
  const auto reached_from = [&](const std::string& start) {
    std::set<std::string> reached;
    std::function<void(const std::string&)> walk = [&](const std::string& node) {
      const auto found = graph.find(node);
      if (found == graph.end()) return;
      for (const std::string& next : found->second) {
        if (reached.insert(next).second) walk(next);
      }
    };
    walk(start);
    return reached;
  };
  std::vector<std::string> circular;
  for (const auto& [node, next] : graph) {
    if (reached_from(node).contains(node)) circular.push_back(node);
  }
  return circular;
}

}  // namespace

std::vector<SourceFile> read_sources(const fs::path& root,
                                     const std::vector<std::string>& folders) {
  std::vector<SourceFile> sources;
  for (const std::string& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path extension = entry.path().extension();
      if (extension == ".h" || extension == ".cpp") {
        sources.push_back(read_source(root, entry.path()));
      }
    }
  }
  std::ranges::sort(sources, {}, &SourceFile::path);
  return sources;
}

std::vector<std::string> forbidden_includes(const std::vector<SourceFile>& sources,
                                            const Modules& modules) {
  std::vector<std::string> forbidden;
  for (const SourceFile& source : sources) {
    const auto row = modules.find(source.module_name());
    if (row == modules.end()) {
      forbidden.push_back(source.path + " stands in no room of the table");
      continue;
    }
    for (const std::string& include : source.own) {
      const std::string module_name = fs::path(include).parent_path().string();
      if (module_name != row->first &&
          std::ranges::find(row->second, module_name) == row->second.end()) {
        forbidden.push_back(source.path + ": " + row->first + " may not use " + include);
      }
    }
  }
  return forbidden;
}

std::vector<std::string> circular_modules(const Modules& modules) {
  return nodes_on_circles(modules);
}

std::vector<std::string> circular_headers(const std::vector<SourceFile>& sources) {
  Graph graph;
  for (const SourceFile& source : sources) {
    if (source.is_header()) graph[source.path] = source.own;
  }
  return nodes_on_circles(graph);
}

std::vector<std::string> heavy_headers(const std::vector<SourceFile>& sources,
                                       const std::vector<std::string>& heavy_packages) {
  std::vector<std::string> heavy;
  for (const SourceFile& source : sources) {
    if (!source.is_header()) continue;
    for (const std::string& include : source.packages) {
      const bool is_heavy = std::ranges::any_of(
          heavy_packages, [&](const std::string& package) { return include.starts_with(package); });
      if (is_heavy) heavy.push_back(source.path + " shows <" + include + "> to all who include it");
    }
  }
  return heavy;
}

}  // namespace skycap::structure
