/// Messages for flight control by setpoints. Names, fields and units follow MAVLink's common
/// message set (EKF_STATUS_REPORT: ardupilotmega).
#pragma once

#include <array>
#include <cstdint>

#include "flight/mavlink/message.h"

namespace skycap::flight::mavlink {

struct Heartbeat {
  static constexpr std::uint32_t id = 0;
  static constexpr const char* name = "HEARTBEAT";
  std::uint32_t custom_mode = 0;
  std::uint8_t type = 0, autopilot = 0, base_mode = 0, system_status = 0, mavlink_version = 3;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("custom_mode", self.custom_mode);
    visit("type", self.type);
    visit("autopilot", self.autopilot);
    visit("base_mode", self.base_mode);
    visit("system_status", self.system_status);
    visit("mavlink_version", self.mavlink_version);
  }
};

struct SystemStatus {
  static constexpr std::uint32_t id = 1;
  static constexpr const char* name = "SYS_STATUS";
  std::uint32_t present = 0, enabled = 0, health = 0;
  std::uint16_t load = 0, voltage_battery = 0;
  std::int16_t current_battery = 0;
  std::uint16_t drop_rate = 0, errors = 0;
  std::array<std::uint16_t, 4> counts{};
  std::int8_t battery_remaining = -1;  ///< Remaining charge [%]. -1: unknown.

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("onboard_control_sensors_present", self.present);
    visit("onboard_control_sensors_enabled", self.enabled);
    visit("onboard_control_sensors_health", self.health);
    visit("load", self.load);
    visit("voltage_battery", self.voltage_battery);
    visit("current_battery", self.current_battery);
    visit("drop_rate_comm", self.drop_rate);
    visit("errors_comm", self.errors);
    visit_each(visit, {"errors_count1", "errors_count2", "errors_count3", "errors_count4"},
               self.counts);
    visit("battery_remaining", self.battery_remaining);
  }
};

struct Attitude {
  static constexpr std::uint32_t id = 30;
  static constexpr const char* name = "ATTITUDE";
  std::uint32_t time_boot_ms = 0;
  float roll = 0.0F, pitch = 0.0F, yaw = 0.0F;  ///< Attitude [rad]. Yaw is clockwise from north.
  float roll_rate = 0.0F, pitch_rate = 0.0F, yaw_rate = 0.0F;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("time_boot_ms", self.time_boot_ms);
    visit("roll", self.roll);
    visit("pitch", self.pitch);
    visit("yaw", self.yaw);
    visit("rollspeed", self.roll_rate);
    visit("pitchspeed", self.pitch_rate);
    visit("yawspeed", self.yaw_rate);
  }
};

/// Name of an autopilot's parameter; zeros fill the rest.
using ParameterName = std::array<char, 16>;

struct ParameterRequest {
  static constexpr std::uint32_t id = 20;
  static constexpr const char* name = "PARAM_REQUEST_READ";
  std::int16_t index = -1;  ///< -1: by name
  Address target;
  ParameterName parameter{};

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("param_index", self.index);
    visit_target(visit, self.target);
    visit("param_id", self.parameter);
  }
};

struct ParameterValue {
  static constexpr std::uint32_t id = 22;
  static constexpr const char* name = "PARAM_VALUE";
  float value = 0.0F;
  std::uint16_t count = 0, index = 0;
  ParameterName parameter{};
  std::uint8_t type = 9;  ///< MAV_PARAM_TYPE; 9: a float

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("param_value", self.value);
    visit("param_count", self.count);
    visit("param_index", self.index);
    visit("param_id", self.parameter);
    visit("param_type", self.type);
  }
};

struct GlobalPosition {
  static constexpr std::uint32_t id = 33;
  static constexpr const char* name = "GLOBAL_POSITION_INT";
  std::uint32_t time_boot_ms = 0;
  std::int32_t latitude = 0, longitude = 0;            ///< Geodetic coordinates [1e-7 degrees].
  std::int32_t height_msl = 0, height_above_home = 0;  ///< Heights AMSL and above home [mm].
  /// Velocity in the NED frame [cm/s].
  std::int16_t north_speed = 0, east_speed = 0, down_speed = 0;
  std::uint16_t heading = 0;  ///< Heading [0.01 degrees].

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("time_boot_ms", self.time_boot_ms);
    visit("lat", self.latitude);
    visit("lon", self.longitude);
    visit("alt", self.height_msl);
    visit("relative_alt", self.height_above_home);
    visit("vx", self.north_speed);
    visit("vy", self.east_speed);
    visit("vz", self.down_speed);
    visit("hdg", self.heading);
  }
};

struct CommandLong {
  static constexpr std::uint32_t id = 76;
  static constexpr const char* name = "COMMAND_LONG";
  std::array<float, 7> params{};
  std::uint16_t command = 0;
  Address target;
  std::uint8_t confirmation = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit_each(visit, {"param1", "param2", "param3", "param4", "param5", "param6", "param7"},
               self.params);
    visit("command", self.command);
    visit_target(visit, self.target);
    visit("confirmation", self.confirmation);
  }
};

struct CommandAnswer {
  static constexpr std::uint32_t id = 77;
  static constexpr const char* name = "COMMAND_ACK";
  std::uint16_t command = 0;
  std::uint8_t result = 0;  ///< MAV_RESULT. 0: accepted.

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("command", self.command);
    visit("result", self.result);
  }
};

struct PositionTarget {
  static constexpr std::uint32_t id = 86;
  static constexpr const char* name = "SET_POSITION_TARGET_GLOBAL_INT";
  std::uint32_t time_boot_ms = 0;
  std::int32_t latitude = 0, longitude = 0;  ///< Geodetic coordinates [1e-7 degrees].
  float height = 0.0F;                       ///< Height with the reference of `frame` [m].
  std::array<float, 3> velocity{};           ///< North, east and down [m/s].
  std::array<float, 3> acceleration{};       ///< North, east and down [m/s^2].
  float yaw = 0.0F, yaw_rate = 0.0F;  ///< Yaw clockwise from north [rad] and its rate [rad/s].
  std::uint16_t ignored = 0;          ///< Bit mask of unused fields.
  Address target;
  std::uint8_t frame = 0;  ///< MAV_FRAME.

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("time_boot_ms", self.time_boot_ms);
    visit("lat_int", self.latitude);
    visit("lon_int", self.longitude);
    visit("alt", self.height);
    visit_each(visit, {"vx", "vy", "vz"}, self.velocity);
    visit_each(visit, {"afx", "afy", "afz"}, self.acceleration);
    visit("yaw", self.yaw);
    visit("yaw_rate", self.yaw_rate);
    visit("type_mask", self.ignored);
    visit_target(visit, self.target);
    visit("coordinate_frame", self.frame);
  }
};

struct EstimatorStatus {
  static constexpr std::uint32_t id = 193;
  static constexpr const char* name = "EKF_STATUS_REPORT";
  std::array<float, 5> variances{};
  std::uint16_t flags = 0;  ///< EKF_STATUS_FLAGS.

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit_each(visit,
               {"velocity_variance", "pos_horiz_variance", "pos_vert_variance", "compass_variance",
                "terrain_alt_variance"},
               self.variances);
    visit("flags", self.flags);
  }
};

struct StatusText {
  static constexpr std::uint32_t id = 253;
  static constexpr const char* name = "STATUSTEXT";
  std::uint8_t severity = 0;    ///< Syslog severity, 0 to 7. Up to 4: warning or worse.
  std::array<char, 50> text{};  ///< Without a terminating zero if it fills the array.

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("severity", self.severity);
    visit("text", self.text);
  }
};

struct GimbalAttitude {
  static constexpr std::uint32_t id = 285;
  static constexpr const char* name = "GIMBAL_DEVICE_ATTITUDE_STATUS";
  std::uint32_t time_boot_ms = 0;
  std::array<float, 4> turn{};  ///< Quaternion w, x, y, z in the frame forward, right, down.
  std::array<float, 3> rates{};
  std::uint32_t failures = 0;
  std::uint16_t flags = 0;
  Address target;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("time_boot_ms", self.time_boot_ms);
    visit("q", self.turn);
    visit_each(visit, {"angular_velocity_x", "angular_velocity_y", "angular_velocity_z"},
               self.rates);
    visit("failure_flags", self.failures);
    visit("flags", self.flags);
    visit_target(visit, self.target);
  }
};

/// Returns the CRC extra byte of a message above, or std::nullopt for other messages.
inline std::optional<std::uint8_t> guided_extra_byte(std::uint32_t id) {
  return find_crc_extra<Heartbeat, SystemStatus, Attitude, GlobalPosition, CommandLong,
                        CommandAnswer, PositionTarget, EstimatorStatus, StatusText, GimbalAttitude,
                        ParameterRequest, ParameterValue>(id);
}

}  // namespace skycap::flight::mavlink
