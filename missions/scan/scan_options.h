/// How a mission's sensor is carried while it scans, as its section `scan` says.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "sim/sensors/navigation_errors.h"

namespace skycap::missions::scan {

/// Level circles round a point, from the lowest to the highest, with a straight climb between.
struct OrbitOptions {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< its z is what heights count from
  double radius = 30.0;
  double lowest = 10.0;   ///< height of the first circle
  double highest = 30.0;  ///< of the last
  int circles = 3;        ///< evenly spaced in height
  double speed = 6.0;     ///< along circles and climbs [m/s]
  double start = 0.0;     ///< where circles begin: from east, anticlockwise [rad]
};

/// In which coordinates a scan's LAS files are.
enum class ScanCrs {
  local,  ///< the mission's frame
  utm,    ///< UTM on WGS84, in the zone of the frame's origin
};

/// What `skycap scan` records, and how well its carrier knows where it is. Body frame: x forward,
/// y left, z up.
struct FlownScanOptions {
  std::string sensor = "ouster_os1_128";  ///< a preset, or the path of a description
  std::optional<std::string> route;       ///< a file; in place of the orbit
  OrbitOptions orbit;
  ScanCrs crs = ScanCrs::local;                               ///< utm needs the mission's place
  double speed = 5.0;                                         ///< along routes without times [m/s]
  Eigen::Vector3d mount_position = Eigen::Vector3d::Zero();   ///< of the sensor, body frame
  Eigen::Vector3d mount_rotation = Eigen::Vector3d::Zero();   ///< [rad], about x, then y, then z
  sim::NavigationErrors navigation;                           ///< its seed is the run's
  Eigen::Vector3d lever_arm_error = Eigen::Vector3d::Zero();  ///< of the believed mount_position
  Eigen::Vector3d boresight_error = Eigen::Vector3d::Zero();  ///< of the believed rotation [rad]
  double frame_period = 1.0;  ///< of a camera along a route with times [s]
  double depth_unit = 0.001;  ///< of a depth image [m]

  /// Where the frame is on the Earth, for routes in such coordinates; nothing: not known.
  std::optional<flight::Site> site;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();  ///< where heights above take-off count from

  /// How the sensor sits on its carrier, body_from_sensor.
  Eigen::Isometry3d mount() const;
};

}  // namespace skycap::missions::scan
