/// What follows from a mission's prior data: maps, models, terrain and earlier scans of its site.
#pragma once

#include "missions/file/mission_reader.h"
#include "missions/prior/site_priors.h"

namespace skycap::missions::derived {

/// Checks the keys of `prior`, makes its paths absolute, for the package holds the mission
/// elsewhere, and reads its files into mission.priors. Throws Error{bad_config} as
/// MissionFile::refuse(), naming the key of the source.
void read_priors(file::MissionFile& given);

/// planner.scene_box where the mission has none but targets: around them, with the view distance
/// on every side.
void derive_scene_box(file::Mission& mission);

/// The mission's prior data; none of it if it has none.
const prior::SitePriors& priors_of(const file::Mission& mission);

}  // namespace skycap::missions::derived
