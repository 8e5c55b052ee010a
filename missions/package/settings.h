/// Storage of a mission's keys in results, so that the mission can be repeated from its results.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "missions/config/key_override.h"
#include "missions/config/mission_setup.h"

namespace skycap::missions::package {

/// Returns all effective keys by path. Seed and threads are those of the run.
nlohmann::ordered_json settings_json(const config::MissionSetup& setup);

/// Restores the mission from stored settings and applies overrides. `name` is the file name in
/// messages. Throws Error{bad_file} for unknown keys, and all errors of parse_mission().
config::MissionSetup mission_from_settings(const nlohmann::ordered_json& settings,
                                           const std::string& name,
                                           const std::vector<config::KeyOverride>& overrides = {});

}  // namespace skycap::missions::package
