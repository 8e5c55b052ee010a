/// Files of the sample flight that tests corrupt and interpret.
#pragma once

#include "flight/export/export.h"
#include "flight/export/mavlink_files.h"
#include "flight/interpreter/interpreted_route.h"
#include "flight/interpreter/mission_interpreter.h"
#include "tests/flight/export/sample_plan.h"

namespace skycap::flight {

/// Returns the sample flight in the format of the autopilot: .plan for PX4, .waypoints for
/// ArduPilot.
MavlinkMission sample_file(AutopilotType autopilot);
FlightFacts sample_facts(AutopilotType autopilot);

/// Returns all problems of a flight at the sample site with 2 m clearance.
Problems find_problems(const InterpretedRoute& route);
Problems find_problems(const MavlinkMission& file, AutopilotType autopilot);

/// Returns the index of the n-th item with this command.
std::size_t find_index(const MavlinkMission& file, int command, std::size_t n = 0);

/// Returns the index of the waypoint of the n-th capture point. find_hold() returns that of the
/// item that holds before its captures.
std::size_t find_waypoint(const MavlinkMission& file, std::size_t n = 0);
std::size_t find_hold(const MavlinkMission& file, std::size_t n = 0);

/// Returns the latitude and longitude of a local position in the sample's frame.
GeodeticPoint position_at(const Eigen::Vector3d& local);

/// Moves an item to a local position, with its altitude relative to home.
void move(MissionItem& item, const Eigen::Vector3d& local);

}  // namespace skycap::flight
