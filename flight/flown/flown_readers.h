/// Readers of the single kinds of flight logs, see flown_log.h.
#pragma once

#include <functional>
#include <istream>
#include <string>
#include <string_view>

#include "flight/flown/flown_log.h"

namespace skycap::flight {

/// Collects the states and captures of a log in the order of its messages. The camera's direction
/// and the heading of a state are those of the last reading before it.
class FlownLogBuilder {
 public:
  explicit FlownLogBuilder(std::string kind) { log_.kind = std::move(kind); }

  void set_yaw(double time, double yaw_deg);
  /// Sets the direction of the camera. `yaw_deg` is `unspecified` if it is unknown.
  void set_camera(double time, double yaw_deg, double pitch_deg);
  /// Returns the last heading of the vehicle, or `unspecified`.
  double yaw_deg() const { return yaw_deg_; }

  /// Adds a position with the current directions. Ignores positions that are not on the Earth.
  void add_position(double time, const Eigen::Vector3d& location, double above_takeoff);
  /// Adds a capture with the current directions. A location that is not finite is interpolated
  /// between the positions at the end.
  void add_capture(double time, const Eigen::Vector3d& location, double above_takeoff,
                   double yaw_deg = unspecified);
  void warn(std::string sentence) { log_.warnings.push_back(std::move(sentence)); }

  bool has_positions() const { return !log_.states.empty(); }
  bool has_captures() const { return !log_.captures.empty(); }
  FlownLog& log() { return log_; }

  /// Returns the log with interpolated captures and a warning for each gap. Throws Error{bad_file}
  /// with the text `missing` if it contains no position.
  FlownLog finish(const std::string& missing);

 private:
  LoggedState make_state(double time, const Eigen::Vector3d& location, double above_takeoff) const;

  FlownLog log_;
  double yaw_deg_ = unspecified, yaw_time_ = 0.0;
  double camera_yaw_deg_ = unspecified, camera_pitch_deg_ = unspecified, camera_time_ = 0.0;
  double last_position_ = unspecified;
  std::size_t gaps_ = 0;
  double longest_gap_ = 0.0, gap_time_ = 0.0, lost_ = 0.0;
};

/// Passes the bytes of a stream to a parser. `parse` returns the number of bytes that it used of
/// the first argument; the rest is passed again with the next piece. The second argument states
/// that no bytes follow.
void parse_in_pieces(std::istream& stream,
                     const std::function<std::size_t(std::string_view, bool)>& parse);

/// Positions come from POS (otherwise GPS), headings from ATT, the direction of the camera from
/// MNT, and captures from CAM (otherwise TRIG).
FlownLog read_dataflash_track(std::istream& stream);

/// Positions come from vehicle_global_position, otherwise from vehicle_local_position or the
/// receiver. Headings come from vehicle_attitude, the direction of the camera from
/// gimbal_device_attitude_status or mount_orientation. Captures come from camera_capture, otherwise
/// from camera_trigger.
FlownLog read_ulog_track(std::istream& stream);

FlownLog read_tum_track(const std::string& text);
FlownLog read_trajectory_track(const std::string& text);  ///< CSV trajectory of Skycap
FlownLog read_csv_track(std::string_view text);           ///< CSV with latitude and longitude
FlownLog read_mrk_track(std::string_view text);           ///< positions of photos of DJI cameras
FlownLog read_gpx_track(const std::string& text);
FlownLog read_srt_track(std::string_view text);  ///< subtitles of DJI videos

}  // namespace skycap::flight
