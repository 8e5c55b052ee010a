/// Parts of a flight log that are relevant to energy and time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace skycap::flight {

/// Log entry at one time.
struct LogSample {
  double time = 0.0;                                   ///< Time [s].
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< Ground velocity: east, north, up [m/s].
  double power = 0.0;                                  ///< Power of all batteries [W].
};

struct LogParameter {
  std::string name;
  double value = 0.0;
};

/// Mission item that the autopilot started to execute.
struct LogCommand {
  double time = 0.0;  ///< Time [s].
  int command = 0;    ///< MAV_CMD.
  double first_parameter = 0.0, second_parameter = 0.0;
  double latitude_deg = 0.0, longitude_deg = 0.0, height = 0.0;
};

struct FlightLog {
  std::vector<LogSample> samples;        ///< In ascending order of time.
  std::vector<LogParameter> parameters;  ///< Values at the start of the log and later changes.
  std::vector<LogCommand> commands;      ///< In order of execution.
  std::size_t damaged = 0;               ///< Number of messages with impossible values.
};

inline constexpr std::size_t largest_log = std::size_t{512} << 20, max_log_samples = 10'000'000;

/// Reads an ArduPilot dataflash log (.bin). Power comes from BAT (before Copter 3.5: CURR) and
/// velocity from XKF1, NKF1 or EKF1. Parameters come from PARM; executed items from MISE (before
/// October 2024: CMD). The formats are those described in the log (FMT; AP_Logger/LogStructure.h).
///
/// Skips damaged data: messages without a valid successor, and physically impossible readings.
/// Times continue after a restart of the clock. Throws Error{bad_file} if the file is a different
/// kind of log, or lacks power or velocity.
FlightLog read_dataflash(std::string_view bytes, std::size_t max_entries = max_log_samples);

/// Reads text with a header line that names the columns time_s, east_m_s, north_m_s, up_m_s and
/// power_w in any order. Other columns are ignored. Throws Error{bad_file} with the line number.
FlightLog read_csv_log(std::string_view text, std::size_t max_samples = max_log_samples);

/// Reads either format: CSV if the name ends in .csv, otherwise dataflash. Errors include the file
/// name.
FlightLog read_flight_log(const std::filesystem::path& file);

}  // namespace skycap::flight
