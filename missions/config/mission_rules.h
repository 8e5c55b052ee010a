/// Checks of key combinations. Each check throws Error{bad_config} through
/// MissionDocument::reject() for the first violated rule, naming one of the keys involved.
#pragma once

#include "missions/config/mission_document.h"

namespace skycap::missions::config {

/// Checks the mission name, the scene's model and planner.scene_box.
void check_scene(const MissionDocument& document);

/// Checks that a mission without a scene sets planner.scene_box and, with a vehicle,
/// start.position.
void check_live(const MissionDocument& document);

/// Checks the first view.
void check_start(const MissionDocument& document);

/// Checks the depth camera and the capture mode.
void check_sensor(const MissionDocument& document);

/// Checks that the planner supports planner.density_per_m2, and that planner.density and
/// planner.spacing do not conflict with it. Requires the completed spacing.
void check_density(const MissionDocument& document);

/// Checks the georeference. With a vehicle, it also checks the clearance budget, the take-off
/// climb, the wind limit and the flight mode.
void check_flight(const MissionDocument& document);

/// Selects the first vehicle of the fleet for the survey flight. A fleet of one vehicle is
/// converted to a single vehicle. Throws Error{bad_config} if vehicle and pad keys conflict.
void lead_fleet(MissionDocument& document);

/// Applies check_flight() to the other vehicles of the fleet. The fleet must have a georeference,
/// fly with stops, and keep a separation of at least the vehicles' radii and position errors.
void check_fleet(const MissionDocument& document);

/// Checks the height and pitch limits of views. Requires a completed limits.ground_clearance.
void check_view_limits(const MissionDocument& document);

/// Checks the settings of the mission's planner; settings of other planners are ignored.
void check_planner(const MissionDocument& document);

}  // namespace skycap::missions::config
