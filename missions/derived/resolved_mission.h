/// A mission ready to be run: what its file says, checked as a whole and completed by what follows
/// from it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "missions/derived/report.h"
#include "missions/file/mission_reader.h"

namespace skycap::missions::derived {

/// Reads the scanner and the vehicle that the mission names, fills in the values that follow from
/// others, and checks that the keys go together and that the mission's planner can work with its
/// settings. Throws Error{bad_config} as MissionFile::refuse() for the first that is wrong.
/// `report`, here and below, is told which file of prior data it is at: there may be thousands.
file::Mission resolved(file::MissionFile given, const Report& report = {});

/// read_mission_file() and resolved(); throws what they throw, and Error{bad_config} if the mission
/// has no scene: it is for live surveys.
file::Mission read_mission(const std::filesystem::path& file,
                           const std::vector<file::KeyOverride>& overrides = {},
                           const Report& report = {});

/// The same with or without a scene. Throws Error{bad_config} naming a key that a mission without
/// one has to give.
file::Mission read_live_mission(const std::filesystem::path& file,
                                const std::vector<file::KeyOverride>& overrides = {},
                                const Report& report = {});

/// The same for a mission that is already in memory; `name` stands for the file in messages.
file::Mission parse_mission(const std::string& text, const std::string& name,
                            const std::vector<file::KeyOverride>& overrides = {});

}  // namespace skycap::missions::derived
