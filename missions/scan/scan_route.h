/// Path of a sensor's platform from a route file or an orbit.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "missions/scan/scan_options.h"
#include "sim/sensors/trajectory.h"

namespace skycap::missions::scan {

/// Part that the sensor is mounted on. Routes with gimbal angles define both.
enum class Platform {
  airframe,  ///< Remains level, with the heading of the route.
  gimbal,    ///< Follows the direction of the route's camera.
};

struct ScanRoute {
  sim::Trajectory platform;  ///< world_from_body; body: x forward, y left, z up.
  /// Capture times of a camera [s]; empty if the route does not define them.
  std::vector<double> image_times;
};

/// Reads a route in one of these formats:
/// - .tum, .txt: `time x y z qx qy qz qw` of world_from_camera. The platform has this pose for
///   both values of `platform`.
/// - .csv: a trajectory written by flight/export/trajectory_file.h, or views as in views.csv.
/// - .plan, .waypoints, .kmz, .kml, .geojson, .json: the points of a file supported by
///   flight/export, with the options' site and pad and a forward-looking sensor.
/// - Folder of a mission package: mission.csv, or mission-1.csv, mission-2.csv and so on in
///   order, or views.csv if the mission has no flight.
///
/// Views and points are connected by straight lines at the options' speed, with rotations at 1
/// rad/s in place. An image is taken at each view. Throws Error{bad_file} with a one-line message,
/// and Error{bad_config} if the file has geodetic coordinates but the options have no site.
ScanRoute read_scan_route(const std::filesystem::path& path, const ScanFlightOptions& options,
                          Platform platform);

/// Returns level circles at constant speed with the nose in the direction of flight. Time starts at
/// zero.
sim::Trajectory orbit_trajectory(const OrbitOptions& orbit);

/// Returns body_from_camera of a forward-looking camera, whose optical axis is the x axis of the
/// body.
Eigen::Isometry3d body_from_camera();

}  // namespace skycap::missions::scan
