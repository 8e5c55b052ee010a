/// Mission files of the MAVLink world: QGroundControl's .plan and the "QGC WPL 110" text format.
///
/// There is no official schema of either: the loaders of QGroundControl, MAVSDK and Mission Planner
/// are. The validators ask for what the strictest of them asks for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flight/export/flight_plan.h"
#include "flight/export/mission_items.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// A .plan file. Needs the geoid undulation (home is stored above mean sea level). No-fly volumes
/// are flattened as flat_no_fly() says. Throws what mission_items() throws.
std::string write_plan(const FlightPlan& plan);

/// What is wrong with a .plan file; empty when it is good.
Problems validate_plan(const std::string& text);

/// Its items and route. Throws Error{bad_file} with the first problem.
std::vector<MissionItem> read_plan_items(const std::string& text);
RouteFile read_plan(const std::string& text);

/// A .waypoints file; in the ArduPilot dialect line 0 is home and needs the geoid undulation.
std::string write_waypoints(const FlightPlan& plan);

/// What is wrong with a .waypoints file for that autopilot; empty when it is good.
Problems validate_waypoints(const std::string& text, std::optional<Dialect> dialect = {});

std::vector<MissionItem> read_waypoints_items(const std::string& text);
RouteFile read_waypoints(const std::string& text);

}  // namespace skycap::flight
