/// Positions and camera events of a flight log, for the comparison of a flight with its plan.
///
/// Logs of autopilots are read in pieces. Memory depends on the duration of the flight, not on the
/// size of the file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/flight_plan.h"

namespace skycap::flight {

/// Logged state of the vehicle at one time. Angles that are not logged are `unspecified`.
struct LoggedState {
  double time = 0.0;  ///< Time since an arbitrary start [s].
  /// Latitude [deg], longitude [deg] and height above FlownLog::datum [m], or a position in the
  /// mission's frame [m].
  Eigen::Vector3d location = Eigen::Vector3d::Zero();
  double above_takeoff = unspecified;     ///< Height above the take-off point [m].
  double yaw_deg = unspecified;           ///< Heading of the vehicle, clockwise from north.
  double camera_yaw_deg = unspecified;    ///< Heading of the camera, clockwise from north.
  double camera_pitch_deg = unspecified;  ///< Pitch of the camera, 0 at the horizon.
};

/// Content of a log.
struct FlownLog {
  std::string kind;                                 ///< Kind of log, such as "PX4 ULog".
  bool is_local = false;                            ///< Locations are in the mission's frame.
  HeightDatum datum = HeightDatum::mean_sea_level;  ///< Height reference of geodetic locations.
  std::vector<LoggedState> states;                  ///< In ascending order of time.
  std::vector<LoggedState> captures;  ///< Photos or scans, in ascending order of time.
  /// True if the log contains camera events, or is of a kind that contains them after each photo.
  bool has_captures = false;
  std::vector<std::string> warnings;  ///< Damage and gaps, one sentence each.
};

/// Minimum time between stored states [s].
inline constexpr double min_state_interval = 0.1;
/// Minimum time between two logged positions that is reported as a gap [s].
inline constexpr double min_log_gap = 3.0;

/// Reads a log. These kinds are supported:
///
/// - .bin: ArduPilot dataflash log
/// - .ulg: PX4 ULog
/// - .mrk: table of DJI photos
/// - .csv: table with the columns latitude, longitude and a height, or a trajectory of Skycap
/// - .gpx: track
/// - .srt: subtitles of DJI videos
/// - .tum, .txt: TUM trajectory of the camera
///
/// Skips damaged data and reports it in `warnings`. Throws Error{bad_file} with the file name if
/// the file has a different kind or contains no position. Encrypted flight records of DJI are
/// rejected with the files to use instead.
FlownLog read_flown_log(const std::filesystem::path& file);

}  // namespace skycap::flight
