/// Files of the sample flight, to be spoiled and interpreted.
#pragma once

#include "flight/export/export.h"
#include "flight/export/mavlink_files.h"
#include "flight/interpreter/interpreted_route.h"
#include "flight/interpreter/mission_interpreter.h"
#include "tests/flight/export/sample_plan.h"

namespace skycap::flight {

/// The sample flight as the file of that autopilot: PX4's .plan, ArduPilot's .waypoints.
MavlinkMission sample_file(AutopilotType autopilot);
FlightFacts sample_facts(AutopilotType autopilot);

/// All that is wrong with a flight over the sample's site at 2 m.
Problems find_problems(const InterpretedRoute& route);
Problems find_problems(const MavlinkMission& file, AutopilotType autopilot);

/// The index of the n-th item with that command.
std::size_t find_index(const MavlinkMission& file, int command, std::size_t n = 0);

/// The index of the waypoint of the n-th station, and of the item that holds before its shots.
std::size_t find_waypoint(const MavlinkMission& file, std::size_t n = 0);
std::size_t find_hold(const MavlinkMission& file, std::size_t n = 0);

/// The place of a local position in the sample's frame: latitude and longitude.
GeodeticPoint position_at(const Eigen::Vector3d& local);

/// Moves an item to a local position, its height above home.
void move(MissionItem& item, const Eigen::Vector3d& local);

}  // namespace skycap::flight
