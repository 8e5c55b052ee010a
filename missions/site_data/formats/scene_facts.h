/// What decides where a scene's surfaces are and assimp passes over: glTF's extensions, the units
/// and places of IFC.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::missions::site_data {

struct SceneFacts {
  std::optional<double> unit;      ///< metres of what assimp hands on, if that is not 1
  std::vector<std::string> notes;  ///< sentences for the user
};

/// Throws Error{bad_file} if a glTF text needs an extension that is not read.
SceneFacts gltf_facts(const std::filesystem::path& file, std::string_view json);

/// Throws Error{bad_file} if an IFC text does not say what its lengths are in, and `has_unit` does
/// not say that the source does.
SceneFacts ifc_facts(const std::filesystem::path& file, std::string_view text, bool has_unit);

/// The JSON of a glTF file, text or binary; empty if it is cut short.
std::string gltf_json(const std::filesystem::path& file);

}  // namespace skycap::missions::site_data
