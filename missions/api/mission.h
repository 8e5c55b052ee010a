/// Access to missions from other programs: reads, checks and completes mission files as `skycap
/// plan` does.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "geometry/pose/camera.h"
#include "geometry/surfaces/mesh.h"
#include "survey/planner.h"

namespace skycap::missions::api {

/// Override of a mission key.
struct Setting {
  std::string key;    ///< key path, such as "planner.name"
  std::string value;  ///< value in the notation of a mission file
};

/// Immutable mission. Copies share their contents and may be used concurrently.
class Mission {
 public:
  /// Reads a mission file. Throws Error{bad_file} if it cannot be read. Throws Error{bad_config}
  /// with the one-line message "FILE:LINE: key KEY WHAT IS WRONG; what would be right".
  static Mission load(const std::filesystem::path& file, const std::vector<Setting>& settings = {});

  /// Reads a mission from a string. `name` is the file name in messages; its folder is the base of
  /// relative paths. Throws Error{bad_config} as load().
  static Mission parse(const std::string& text, const std::string& name,
                       const std::vector<Setting>& settings = {});

  const std::string& name() const;
  std::uint64_t seed() const;

  /// Returns the camera model that planners use. For a laser scanner, it is an equivalent camera.
  const geometry::CameraConfig& camera() const;

  /// Returns the coverage distance r_d [m], the maximum distance of a measurement from covered
  /// surface.
  double coverage_distance() const;

  /// Returns the placed scene model without the ground. It is the ground truth, which planners must
  /// not access. Throws Error{bad_file} or Error{bad_geometry} for missions without a model.
  geometry::Mesh model() const;

  /// Creates the mission's planner without any measurements. Its decisions depend only on the scans
  /// that it receives. Throws Error{bad_config} if a required value would be derived from the scene
  /// and the key is not set.
  std::unique_ptr<survey::Planner> planner() const;

  struct Contents;  ///< defined in mission_contents.h, private to this folder
  const Contents& contents() const { return *contents_; }

 private:
  explicit Mission(std::shared_ptr<const Contents> contents) : contents_(std::move(contents)) {}

  std::shared_ptr<const Contents> contents_;
};

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< public name for user programs
}
