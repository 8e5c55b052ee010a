/// Time-stamped flight as text: poses for evaluation tools, setpoints for autopilots.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// Vehicle state at one time on a leg, straight or curved, or at a stop.
struct TimedState {
  double time = 0.0;  ///< Time since leaving the pad [s].
  Eigen::Vector3d position, velocity, acceleration;
  double yaw = 0.0;         ///< Clockwise from north [rad].
  double yaw_rate = 0.0;    ///< Clockwise [rad/s].
  double pitch = 0.0;       ///< Gimbal pitch [rad].
  bool is_capture = false;  ///< True at a capture.
};

/// Returns the states of the plan from above the pad until back there. States are `interval` [s]
/// apart, with an extra one at the end of every stop, in ascending order of time. Between
/// waypoints, yaw and gimbal rotate at a constant rate. Throws Error{bad_config} unless the
/// interval is positive.
std::vector<TimedState> trajectory(const FlightPlan& plan, double interval);

enum class Frame { enu, ned };

/// Returns CSV with `t,x,y,z,vx,vy,vz,ax,ay,az,yaw,yaw_rate,gimbal_pitch,capture` and a comment
/// line with the frame. Yaw is counter-clockwise from east in ENU and clockwise from north in NED
/// [rad].
std::string write_trajectory_csv(const std::vector<TimedState>& states, Frame frame);
Problems validate_trajectory_csv(const std::string& text);
std::vector<TimedState> read_trajectory_csv(const std::string& text);

/// Camera pose at one time [s].
struct TimedPose {
  double time = 0.0;
  /// Camera pose of the optical frame.
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
};

/// Returns the camera poses of the states.
std::vector<TimedPose> camera_poses(const std::vector<TimedState>& states);

/// Returns the poses in TUM format: `timestamp tx ty tz qx qy qz qw`.
std::string write_tum(const std::vector<TimedPose>& poses);
Problems validate_tum(const std::string& text);
std::vector<TimedPose> read_tum(const std::string& text);

}  // namespace skycap::flight
