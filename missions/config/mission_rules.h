/// Which keys of a mission do not go together, though each is fine alone. Every check throws
/// Error{bad_config} as MissionFile::refuse(), naming one of the keys, for the first rule that is
/// broken.
#pragma once

#include "missions/config/mission_reader.h"

namespace skycap::missions::config {

/// The mission's name, its model and the box around it.
void check_scene(const config::MissionFile& given);

/// What a mission without a scene has to say of its own.
void check_live(const config::MissionFile& given);

/// The first view.
void check_start(const config::MissionFile& given);

/// The depth camera.
void check_sensor(const config::MissionFile& given);

/// The place on the Earth; with a vehicle: what is left of the clearance, the climb and the wind.
void check_flight(const config::MissionFile& given);

/// Where views may be and which way they may look, once the ground clearance is known.
void check_view_limits(const config::MissionFile& given);

/// The settings of the planner that the mission names, and of no other.
void check_planner(const config::MissionFile& given);

}  // namespace skycap::missions::config
