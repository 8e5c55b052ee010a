/// The flight over time, as text: poses for evaluation tools, set points for autopilots.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// The vehicle at a moment of a leg, straight or curved, or of a stop.
struct TimedState {
  double time = 0.0;  ///< from leaving the pad [s]
  Eigen::Vector3d position, velocity, acceleration;
  double yaw = 0.0;       ///< clockwise from north [rad]
  double yaw_rate = 0.0;  ///< clockwise [rad/s]
  double pitch = 0.0;     ///< of the gimbal [rad]
  bool is_shot = false;   ///< a capture at this moment
};

/// The plan's states, from above the pad until back there, every `interval` seconds and at the end
/// of every stop, times ascending. Between stations yaw and gimbal turn evenly. Throws
/// Error{bad_config} unless the interval is positive.
std::vector<TimedState> trajectory(const FlightPlan& plan, double interval);

enum class Frame { enu, ned };

/// `t,x,y,z,vx,vy,vz,ax,ay,az,yaw,yaw_rate,gimbal_pitch,shot`; the frame is named in a comment
/// line. ENU: yaw counter-clockwise from east; NED: clockwise from north. Radians.
std::string write_trajectory_csv(const std::vector<TimedState>& states, Frame frame);
Problems validate_trajectory_csv(const std::string& text);
std::vector<TimedState> read_trajectory_csv(const std::string& text);

/// A camera's pose at a moment.
struct TimedPose {
  double time = 0.0;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();  ///< optical frame
};

/// The cameras' poses of those states.
std::vector<TimedPose> camera_poses(const std::vector<TimedState>& states);

/// TUM: `timestamp tx ty tz qx qy qz qw`.
std::string write_tum(const std::vector<TimedPose>& poses);
Problems validate_tum(const std::string& text);
std::vector<TimedPose> read_tum(const std::string& text);

}  // namespace skycap::flight
