/// Which keys of a mission do not go together, though each is fine alone. Every check throws
/// Error{bad_config} as MissionDocument::refuse(), naming one of the keys, for the first rule that
/// is broken.
#pragma once

#include "missions/config/mission_document.h"

namespace skycap::missions::config {

/// The mission's name, its model and the box around it.
void check_scene(const MissionDocument& given);

/// What a mission without a scene has to say of its own.
void check_live(const MissionDocument& given);

/// The first view.
void check_start(const MissionDocument& given);

/// The depth camera.
void check_sensor(const MissionDocument& given);

/// The place on the Earth; with a vehicle: what is left of the clearance, the climb and the wind.
void check_flight(const MissionDocument& given);

/// Has the first of the fleet's vehicles fly the survey; a fleet of one is none. Throws if keys
/// about vehicles and pads contradict.
void lead_fleet(MissionDocument& given);

/// What check_flight() asks of the first vehicle, of the others, too; and of all together that they
/// have a place on the Earth and a separation that holds their errors.
void check_fleet(const MissionDocument& given);

/// Where views may be and which way they may look, once the ground clearance is known.
void check_view_limits(const MissionDocument& given);

/// The settings of the planner that the mission names, and of no other.
void check_planner(const MissionDocument& given);

}  // namespace skycap::missions::config
