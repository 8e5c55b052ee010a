/// Track of a flight in the frame of its mission.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/geodesy.h"
#include "flight/flown/flown_log.h"

namespace skycap::flight {

/// State of the vehicle in the mission's frame. Angles that are not logged are `unspecified`.
struct TrackState {
  double time = 0.0;                                   ///< Time since an arbitrary start [s].
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< Position [m].
  double yaw_deg = unspecified;           ///< Heading of the vehicle, clockwise from north.
  double camera_yaw_deg = unspecified;    ///< Heading of the camera, clockwise from north.
  double camera_pitch_deg = unspecified;  ///< Pitch of the camera, 0 at the horizon.
};

/// Height that a log is placed by.
enum class TrackHeights {
  automatic,  ///< The height above take-off if the log has it, otherwise the absolute height.
  takeoff,    ///< Height above take-off, or above the first position of the log.
  absolute,   ///< Height above mean sea level or above the ellipsoid.
};

struct FlownTrack {
  std::string kind;                  ///< Kind of log.
  std::string heights;               ///< Height reference that was used.
  std::vector<TrackState> states;    ///< From take-off to landing, in ascending order of time.
  std::vector<TrackState> captures;  ///< In ascending order of time.
  bool has_captures = false;         ///< See FlownLog.
  std::vector<std::string> warnings;
};

/// Places a log in the frame of a mission, and removes the time on the ground before take-off and
/// after landing. `pad` is the take-off point, to which heights above take-off refer. Throws
/// Error{bad_config} if `heights` are above mean sea level and the site's geoid undulation is
/// unknown, or if the site is needed and `is_georeferenced` is false.
FlownTrack place_track(const FlownLog& log, const Site& site, bool is_georeferenced,
                       const Eigen::Vector3d& pad, TrackHeights heights);

/// Appends a later track, for missions of several flights. Its times continue after those of
/// `track`.
void append_track(FlownTrack& track, FlownTrack next);

/// Returns the velocity of a track at `time`, from the positions up to half a second before and
/// after it [m/s]. Zero outside the track.
Eigen::Vector3d compute_velocity(const std::vector<TrackState>& states, double time);

}  // namespace skycap::flight
