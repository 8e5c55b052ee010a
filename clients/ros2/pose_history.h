/// Where something was at the time of a scan: the body by odometry, or a frame by TF.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>

#include "clients/ros2/frames.h"

namespace skycap::ros2 {

using Stamp = std::int64_t;  ///< [ns] of whatever clock the robot goes by

/// Throws Error{bad_geometry} for a stamp that is not set, or has a second's worth of nanoseconds.
Stamp stamp_of(const Header& header);

/// Between which poses it is fair to interpolate.
struct HistoryConfig {
  double longest_gap = 0.1;     ///< from the stamp to the pose before, and to the one after [s]
  double highest_speed = 30.0;  ///< between the two [m/s]; beyond, it has jumped
  double highest_turn = 10.0;   ///< between the two [rad/s]
  std::size_t most = 4096;      ///< poses that are kept; those that came first go first
};

/// What is known of the pose at a stamp.
struct PoseMatch {
  enum class State {
    known,
    open,     ///< not yet; poses may still come
    refused,  ///< and will not be: it jumps there
  };
  State state = State::open;
  BodyPose pose;
  std::string why;  ///< why it is not known
};

/// Messages may come in any order, twice, and with stamps from the future: a pose counts only near
/// its own stamp.
class PoseHistory {
 public:
  explicit PoseHistory(const HistoryConfig& config) : config_(config) {}

  enum class Added { taken, known, contradicts };
  /// `known`: this very pose is there already; `contradicts`: another one with the same stamp is,
  /// and stays.
  Added add(Stamp stamp, const BodyPose& pose);

  /// The pose of that very stamp; or between the poses around it, the position and covariance
  /// linearly and the turn along the great arc.
  PoseMatch at(Stamp stamp) const;

  /// Whether all poses from one stamp to another, both included, have a property.
  bool all_between(Stamp from, Stamp to,
                   const std::function<bool(Stamp, const BodyPose&)>& holds) const;

 private:
  HistoryConfig config_;
  std::map<Stamp, BodyPose> poses_;
  std::deque<Stamp> arrivals_;
};

}  // namespace skycap::ros2
