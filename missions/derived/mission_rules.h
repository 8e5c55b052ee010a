/// Which keys of a mission do not go together, though each is fine alone. Every check throws
/// Error{bad_config} as MissionFile::refuse(), naming one of the keys, for the first rule that is
/// broken.
#pragma once

#include "missions/file/mission_reader.h"

namespace skycap::missions::derived {

/// The mission's name, its model and the box around it.
void check_scene(const file::MissionFile& given);

/// What a mission without a scene has to say of its own.
void check_live(const file::MissionFile& given);

/// The first view.
void check_start(const file::MissionFile& given);

/// The depth camera.
void check_sensor(const file::MissionFile& given);

/// The place on the Earth; with a vehicle: what is left of the clearance, the climb and the wind.
void check_flight(const file::MissionFile& given);

/// Where views may be and which way they may look, once the ground clearance is known.
void check_view_limits(const file::MissionFile& given);

/// The settings of the planner that the mission names, and of no other.
void check_planner(const file::MissionFile& given);

}  // namespace skycap::missions::derived
