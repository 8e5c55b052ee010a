/// Every MAVLink command that is known here, and what the autopilots do with it in a mission.
///
/// Sources: ArduPilot's AP_Mission.cpp (mavlink_int_to_mission_cmd, is_nav_cmd) and ArduCopter's
/// mode_auto.cpp; PX4's mavlink_mission.cpp (parse_mavlink_mission_item) and mission_block.cpp.
/// ArduPilot skips commands that it does not know without a word; PX4 refuses the mission.
#pragma once

namespace skycap::flight {

/// What the interpreter does with a command.
enum class Meaning {
  take_off,       ///< climbs from the pad
  fly_to,         ///< a straight leg, then a hold
  land,           ///< level to the place, then down
  wait,           ///< holds where it is
  turn,           ///< heading of the vehicle
  set_speed,      ///< limits of speed
  aim_by_mount,   ///< gimbal, DO_MOUNT_CONTROL
  aim_by_gimbal,  ///< gimbal, DO_GIMBAL_MANAGER_PITCHYAW
  take_photo,     ///< IMAGE_START_CAPTURE
  trigger_photo,  ///< DO_DIGICAM_CONTROL
  jump,           ///< unrolled
  hold_fence,     ///< switches the fence on
  no_motion,      ///< neither moves the vehicle nor aims its camera
  refused         ///< known to be unsafe or not provable; `why` says it
};

/// Which autopilots execute a command.
enum class FlownBy { both, ardupilot, px4 };

struct CommandRow {
  int id;            ///< MAV_CMD
  const char* name;  ///< without MAV_CMD_
  Meaning meaning;
  FlownBy flown_by;
  const char* why;  ///< of those refused: what the autopilots do with it
};

/// The row of a command; nullptr if it is not known, and refused as such.
const CommandRow* find_command(int id);

/// Whether the command goes to a place of its own.
bool has_place(Meaning meaning);

}  // namespace skycap::flight
