/// Interpolated pose at the time of a scan: of the body from odometry, or of a frame from TF.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>

#include "clients/ros2/frames.h"

namespace skycap::ros2 {

using Stamp = std::int64_t;  ///< Time on the robot's clock [ns].

/// Returns the stamp of a header. Throws Error{bad_geometry} if it is not set, or has 1e9
/// nanoseconds or more.
Stamp to_stamp(const Header& header);

/// Limits for interpolation between poses.
struct HistoryConfig {
  /// Maximum time from the stamp to the previous and to the next pose [s].
  double longest_gap = 0.1;
  /// Maximum speed between the two poses [m/s]. Above it, the pose has jumped.
  double max_speed = 30.0;
  double max_turn_rate = 10.0;  ///< Maximum angular rate between the two poses [rad/s].
  /// Maximum number of stored poses. The first to arrive is removed first.
  std::size_t max = 4096;
};

/// Result of a query for the pose at a stamp.
struct PoseMatch {
  enum class State {
    known,
    open,      ///< Not yet known: further poses may arrive.
    rejected,  ///< Rejected permanently because of a jump.
  };
  State state = State::open;
  BodyPose pose;
  std::string reason;  ///< Reason why it is not known.
};

/// Messages may arrive in any order, twice, or with stamps in the future: a pose is used only near
/// its own stamp.
class PoseHistory {
 public:
  explicit PoseHistory(const HistoryConfig& config) : config_(config) {}

  enum class Added { accepted, known, contradicts };
  /// Adds a pose. `known`: the same pose exists already. `contradicts`: a different pose with the
  /// same stamp exists and is kept.
  Added add(Stamp stamp, const BodyPose& pose);

  /// Returns the pose at the stamp or an interpolated one: linear for position and covariance,
  /// along the great arc for the rotation.
  PoseMatch at(Stamp stamp) const;

  /// Returns true if all poses between two stamps, both included, satisfy `holds`.
  bool all_between(Stamp from, Stamp to,
                   const std::function<bool(Stamp, const BodyPose&)>& holds) const;

 private:
  HistoryConfig config_;
  std::map<Stamp, BodyPose> poses_;
  std::deque<Stamp> arrivals_;
};

}  // namespace skycap::ros2
