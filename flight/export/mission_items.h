/// MAVLink mission items: what the .plan and the .waypoints format both hold.
///
/// Sources: MAVLink common message set; PX4's mavlink_mission.cpp and ArduPilot's AP_Mission.cpp
/// for what each autopilot accepts, ignores and rounds.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// MAV_CMD numbers used here.
namespace command {
inline constexpr int waypoint = 16, loiter_time = 19, return_to_launch = 20, land = 21,
                     takeoff = 22, delay = 93, condition_yaw = 115, jump = 177, change_speed = 178,
                     digicam_control = 203, mount_control = 205, gimbal_pitch_yaw = 1000,
                     start_capture = 2000;
}

/// MAV_FRAME numbers used here.
namespace frame {
inline constexpr int global = 0, mission = 2, relative = 3, global_int = 5, relative_int = 6,
                     terrain = 10;
}

struct MissionItem {
  int command = 0;
  int frame = 0;
  std::array<double, 7> params{};  ///< 4, 5, 6: latitude [deg], longitude [deg], height; NaN: unset
  bool auto_continue = true;
  std::size_t number = 0;  ///< as ground stations show it
};

/// What messages call an item, such as "item 12".
std::string name_of(const MissionItem& item);

/// What its height counts from; neither: the ground below, or nothing.
bool is_above_sea(const MissionItem& item);
bool is_above_home(const MissionItem& item);

/// Whether it has a latitude or a longitude other than zero: stations write both as zero where a
/// place is unknown or not meant.
bool has_coordinates(const MissionItem& item);

/// The items of a sortie, numbered from 1: take-off, speed, and for each stop what the dialect
/// needs in the order that it needs it; the last lands on the pad. Throws Error{bad_config} for
/// vehicles that do not fly MAVLink missions, and if there are more items than the vehicle takes.
std::vector<MissionItem> mission_items(const FlightPlan& plan);

/// Why that autopilot would not take the items, or not as they are written; nothing: any autopilot.
/// What it would do with them is interpreter/mission_interpreter.h's to say.
Problems check_items(const std::vector<MissionItem>& items, std::optional<Dialect> dialect);

/// What the autopilot's memory makes of them: 1e-7 degrees, ArduPilot's whole seconds of hold and
/// centimetres of height, PX4's single-precision heights.
std::vector<MissionItem> as_stored(std::vector<MissionItem> items, Dialect dialect);

/// The places of the items, each with its own datum. The items must have passed check_items().
RouteFile route_of(const std::vector<MissionItem>& items);

}  // namespace skycap::flight
