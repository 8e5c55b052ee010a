/// Table of all supported MAVLink commands and their effect in a mission.
///
/// Sources: ArduPilot's AP_Mission.cpp (mavlink_int_to_mission_cmd, is_nav_cmd) and ArduCopter's
/// mode_auto.cpp; PX4's mavlink_mission.cpp (parse_mavlink_mission_item) and mission_block.cpp.
/// ArduPilot skips unknown commands silently; PX4 rejects the mission.
#pragma once

namespace skycap::flight {

/// Effect of a command in the interpreter.
enum class Meaning {
  take_off,       ///< Climb from the pad.
  fly_to,         ///< Straight leg, then a hold.
  land,           ///< Level flight to the position, then descent.
  wait,           ///< Hold at the current position.
  turn,           ///< Heading of the vehicle.
  set_speed,      ///< Speed limits.
  aim_by_mount,   ///< Gimbal by DO_MOUNT_CONTROL.
  aim_by_gimbal,  ///< Gimbal by DO_GIMBAL_MANAGER_PITCHYAW.
  take_photo,     ///< IMAGE_START_CAPTURE.
  trigger_photo,  ///< DO_DIGICAM_CONTROL.
  space_photos,   ///< DO_SET_CAM_TRIGG_DIST
  jump,           ///< Unrolled by the interpreter.
  hold_fence,     ///< Enables the fence.
  no_motion,      ///< Affects neither motion nor camera aim.
  rejected        ///< Unsafe or not verifiable, with the reason in `reason`.
};

/// Autopilots that execute a command.
enum class SupportedBy { both, ardupilot, px4 };

struct CommandRow {
  int id;            ///< MAV_CMD.
  const char* name;  ///< Name without MAV_CMD_.
  Meaning meaning;
  SupportedBy supported_by;
  const char* reason;  ///< Effect of a rejected command on the autopilots.
};

/// Returns the row of a command, or nullptr if it is unknown. Unknown commands are rejected.
const CommandRow* find_command(int id);

/// Returns true if the command has its own position.
bool has_position(Meaning meaning);

}  // namespace skycap::flight
