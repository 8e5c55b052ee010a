/// MAVLink mission items, common to the .plan and .waypoints formats.
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

/// MAV_CMD numbers in use.
namespace command {
inline constexpr int waypoint = 16, loiter_time = 19, return_to_launch = 20, land = 21,
                     takeoff = 22, delay = 93, condition_yaw = 115, jump = 177, change_speed = 178,
                     digicam_control = 203, mount_control = 205, camera_trigger_distance = 206,
                     gimbal_pitch_yaw = 1000, start_capture = 2000, start_video = 2500,
                     stop_video = 2501;
}

/// MAV_FRAME numbers in use.
namespace frame {
inline constexpr int global = 0, mission = 2, relative = 3, global_int = 5, relative_int = 6,
                     terrain = 10;
}

struct MissionItem {
  int command = 0;
  int frame = 0;
  /// Parameters. Indices 4, 5 and 6: latitude [deg], longitude [deg] and height. NaN: unset.
  std::array<double, 7> params{};
  bool auto_continue = true;
  std::size_t number = 0;  ///< Number shown by ground stations.
};

/// Returns the name of an item for messages, such as "item 12".
std::string item_label(const MissionItem& item);

/// Returns true if the height is AMSL or above home. If both are false, it is above ground or has
/// no reference.
bool is_above_sea(const MissionItem& item);
bool is_above_home(const MissionItem& item);

/// Returns true if latitude or longitude is non-zero. Ground stations write zeros for unknown or
/// unused positions.
bool has_coordinates(const MissionItem& item);

/// Returns the items of a sortie, numbered from 1: take-off, speed, and the items of each stop in
/// the order of the dialect. The last item lands on the pad. Throws Error{bad_config} for vehicles
/// without MAVLink missions, or if the vehicle's limit on items is exceeded.
std::vector<MissionItem> mission_items(const FlightPlan& plan);

/// Returns the reasons why the autopilot would reject or change the items. Without a dialect, the
/// rules of all autopilots apply. For the flight behaviour see interpreter/mission_interpreter.h.
Problems check_items(const std::vector<MissionItem>& items, std::optional<AutopilotType> autopilot);

/// Returns the items as the autopilot stores them: 1e-7 degrees; for ArduPilot integer seconds and
/// centimetres; for PX4 single-precision heights.
std::vector<MissionItem> as_stored(std::vector<MissionItem> items, AutopilotType autopilot);

/// Returns the positions of the items, each with its own datum. The items must have passed
/// check_items().
RouteFile make_route(const std::vector<MissionItem>& items);

}  // namespace skycap::flight
