/// A mission file in the hands of another program: read, checked and completed as `skycap plan`
/// does it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "geometry/place/camera.h"
#include "geometry/surfaces/mesh.h"
#include "survey/planner.h"

namespace skycap::missions::api {

/// A value that takes the place of the file's.
struct Setting {
  std::string key;    ///< such as "planner.name"
  std::string value;  ///< as the file would say it
};

/// Immutable; copies share what they hold and may be used from any number of threads.
class Mission {
 public:
  /// Throws Error{bad_file} if the file cannot be read, and Error{bad_config} with one line,
  /// "FILE:LINE: key KEY WHAT IS WRONG; what would be right".
  static Mission load(const std::filesystem::path& file, const std::vector<Setting>& settings = {});

  /// The same of a mission in memory; `name` stands for the file in messages, and its folder is
  /// where relative paths start.
  static Mission parse(const std::string& text, const std::string& name,
                       const std::vector<Setting>& settings = {});

  const std::string& name() const;
  std::uint64_t seed() const;

  /// The camera by which planners choose views; of a laser scanner, the one that stands for it.
  const geometry::CameraConfig& camera() const;

  /// A surface point with a measurement this near is covered: r_d.
  double coverage_distance() const;

  /// The model of the scene, placed, without ground: the truth, which no planner may see. Throws
  /// Error{bad_file} or Error{bad_geometry} if there is none.
  geometry::Mesh model() const;

  /// The planner that the mission names, which has seen nothing yet. What it does in a survey
  /// depends on nothing but the scans it is given. Throws Error{bad_config} if the planner needs
  /// what follows from the scene and no key says it.
  std::unique_ptr<survey::Planner> planner() const;

  struct Contents;  ///< defined in mission_contents.h, for sources of this folder only
  const Contents& contents() const { return *contents_; }

 private:
  explicit Mission(std::shared_ptr<const Contents> contents) : contents_(std::move(contents)) {}

  std::shared_ptr<const Contents> contents_;
};

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< the name in programs of users
}
