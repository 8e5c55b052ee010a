/// What assimp finds in a file, for its module and whoever loads it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/surfaces/mesh.h"

namespace skycap::missions::site_data {

struct SceneNode {
  std::string id;
  std::optional<std::size_t> parent;  ///< a node before it
  geometry::Mesh mesh;                ///< in the scene's frame, whose y is up, in metres
};

/// The module's function. Throws Error{bad_file}.
using ReadScene = void(const std::filesystem::path& file, std::vector<SceneNode>& nodes);
inline constexpr const char* read_scene_name = "skycap_read_scene";

}  // namespace skycap::missions::site_data
