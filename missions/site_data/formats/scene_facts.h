/// Properties that affect the position of a scene's surfaces but that Assimp ignores: glTF
/// extensions, and the units and georeferences of IFC.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::missions::site_data {

struct SceneFacts {
  std::optional<double> unit;  ///< Length of the unit in Assimp's output [m], if it differs from 1.
  std::vector<std::string> notes;  ///< Sentences for the user.
};

/// Throws Error{bad_file} if the glTF file requires an unsupported extension.
SceneFacts gltf_facts(const std::filesystem::path& file, std::string_view json);

/// Throws Error{bad_file} if the IFC file has no known linear unit, unless `has_unit` is set, which
/// means that the source defines the unit.
SceneFacts ifc_facts(const std::filesystem::path& file, std::string_view text, bool has_unit);

/// Returns the JSON of a glTF file, text or binary; empty if the file is truncated.
std::string gltf_json(const std::filesystem::path& file);

}  // namespace skycap::missions::site_data
