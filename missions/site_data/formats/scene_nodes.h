/// Output of the Assimp module, shared by the module and its loader.
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
  std::optional<std::size_t> parent;  ///< Index of the parent node, which precedes this node.
  geometry::Mesh mesh;                ///< Mesh in the scene frame with y up [m].
};

/// Entry point of the module. Throws Error{bad_file}.
using ReadScene = void(const std::filesystem::path& file, std::vector<SceneNode>& nodes);
inline constexpr const char* read_scene_name = "skycap_read_scene";

}  // namespace skycap::missions::site_data
