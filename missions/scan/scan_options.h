/// Settings in the section `scan` of a mission file.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "sim/sensors/navigation_errors.h"

namespace skycap::missions::scan {

/// Horizontal circles around a point, from the lowest to the highest, connected by vertical climbs.
struct OrbitOptions {
  /// Centre of the circles. Heights are relative to its z [m].
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 30.0;
  double min_height = 10.0;  ///< Height of the first circle [m].
  double max_height = 30.0;  ///< Height of the last circle [m].
  int circles = 3;           ///< Number of circles, at equal height intervals.
  double speed = 6.0;        ///< Speed on circles and climbs [m/s].
  double start = 0.0;        ///< Start angle of the circles, anticlockwise from east [rad].
};

/// Coordinate system of the LAS and E57 files of a scan.
enum class ScanCrs {
  local,  ///< The mission frame.
  utm,    ///< UTM on WGS84, in the zone of the frame's origin.
};

/// Settings of `skycap scan`, including the navigation errors of the platform. Body frame: x
/// forward, y left, z up.
struct ScanFlightOptions {
  std::string sensor = "ouster_os1_128";  ///< Name of a preset, or path of a description.
  std::optional<std::string> route;       ///< Route file; replaces the orbit.
  OrbitOptions orbit;
  /// Coordinate system of LAS and E57 files; utm requires a georeference.
  ScanCrs crs = ScanCrs::local;
  double speed = 5.0;  ///< Speed on routes without times [m/s].
  /// Position of the sensor in the body frame [m].
  Eigen::Vector3d mount_position = Eigen::Vector3d::Zero();
  /// Rotation of the sensor about x, then y, then z [rad].
  Eigen::Vector3d mount_rotation = Eigen::Vector3d::Zero();
  /// Navigation errors; their seed is replaced by that of the run.
  sim::NavigationErrors navigation;
  /// Error of the estimated mount_position [m].
  Eigen::Vector3d lever_arm_error = Eigen::Vector3d::Zero();
  /// Error of the estimated mount_rotation [rad].
  Eigen::Vector3d boresight_error = Eigen::Vector3d::Zero();
  double frame_period = 1.0;  ///< Interval between a camera's images on routes with times [s].
  double depth_unit = 0.001;  ///< Depth per unit of a pixel value [m].

  /// Georeference of the frame, required for routes in geodetic coordinates.
  std::optional<flight::Site> site;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();  ///< Reference position of heights above take-off.

  /// Returns the pose of the sensor on its platform, body_from_sensor.
  Eigen::Isometry3d mount() const;
};

}  // namespace skycap::missions::scan
