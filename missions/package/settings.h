/// A mission's keys as results keep them, so that they can be repeated from the results alone.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "missions/config/key_override.h"
#include "missions/config/mission_setup.h"

namespace skycap::missions::package {

/// All keys as they are in force, by their paths; seed and threads are those of the run.
nlohmann::ordered_json settings_json(const config::MissionSetup& setup);

/// The mission that settings stand for, with overrides; `name` is the file in messages. Throws
/// Error{bad_file} for what is no key, and what parse_mission() throws.
config::MissionSetup mission_of_settings(const nlohmann::ordered_json& settings,
                                         const std::string& name,
                                         const std::vector<config::KeyOverride>& overrides = {});

}  // namespace skycap::missions::package
