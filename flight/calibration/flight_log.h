/// What a vehicle wrote down of a flight, as far as its energy and its minutes show in it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace skycap::flight {

/// A moment of the flight.
struct LogSample {
  double time = 0.0;                                   ///< [s]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< over ground: east, north, up [m/s]
  double power = 0.0;                                  ///< of all batteries [W]
};

struct LogParameter {
  std::string name;
  double value = 0.0;
};

/// A mission item that the autopilot went on to.
struct LogCommand {
  double time = 0.0;  ///< [s]
  int command = 0;    ///< MAV_CMD
  double first_parameter = 0.0, second_parameter = 0.0;
  double latitude_deg = 0.0, longitude_deg = 0.0, height = 0.0;
};

struct FlightLog {
  std::vector<LogSample> samples;        ///< times ascend
  std::vector<LogParameter> parameters;  ///< as they were when the log began, or changed to
  std::vector<LogCommand> commands;      ///< as they were executed
  std::size_t damaged = 0;               ///< messages with values that cannot be
};

inline constexpr std::size_t largest_log = std::size_t{512} << 20, most_log_samples = 10'000'000;

/// ArduPilot's dataflash log (.bin): BAT, before Copter 3.5 CURR, for the power; XKF1, NKF1 or EKF1
/// for the velocity; PARM; MISE for the items executed, in logs before October 2024 CMD. Formats
/// are those that the log itself describes (FMT; AP_Logger/LogStructure.h). What is damaged is
/// skipped: messages that no other follows, and readings that no vehicle has. Times that begin
/// again after a restart go on. Throws Error{bad_file} if it is no such log, saying which kind it
/// is, or lacks one of the first two.
FlightLog read_dataflash(std::string_view bytes, std::size_t most_entries = most_log_samples);

/// Text with a header line that names the columns time_s, east_m_s, north_m_s, up_m_s and power_w,
/// in any order, beside others. Throws Error{bad_file} naming the line.
FlightLog read_csv_log(std::string_view text, std::size_t most_samples = most_log_samples);

/// Either, by the name's ending: .csv or any other. Errors name the file.
FlightLog read_flight_log(const std::filesystem::path& file);

}  // namespace skycap::flight
