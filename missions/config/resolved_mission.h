/// A mission ready to be run: what its file says, checked as a whole and completed by what follows
/// from it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "missions/config/mission_reader.h"
#include "missions/config/report.h"

namespace skycap::missions::config {

/// Reads the scanner and the vehicle that the mission names, fills in the values that follow from
/// others, and checks that the keys go together and that the mission's planner can work with its
/// settings. Throws Error{bad_config} as MissionFile::refuse() for the first that is wrong.
/// `report`, here and below, is told which file of prior data it is at: there may be thousands.
config::Mission resolved(config::MissionFile given, const Report& report = {});

/// read_mission_file() and resolved(); throws what they throw, and Error{bad_config} if the mission
/// has no scene: it is for live surveys.
config::Mission read_mission(const std::filesystem::path& file,
                             const std::vector<config::KeyOverride>& overrides = {},
                             const Report& report = {});

/// The same with or without a scene. Throws Error{bad_config} naming a key that a mission without
/// one has to give.
config::Mission read_live_mission(const std::filesystem::path& file,
                                  const std::vector<config::KeyOverride>& overrides = {},
                                  const Report& report = {});

/// The same for a mission that is already in memory; `name` stands for the file in messages.
config::Mission parse_mission(const std::string& text, const std::string& name,
                              const std::vector<config::KeyOverride>& overrides = {});

}  // namespace skycap::missions::config
