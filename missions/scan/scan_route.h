/// The way of a sensor's carrier: from a route file, or round a point as the mission says.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "missions/scan/scan_options.h"
#include "sim/sensors/trajectory.h"

namespace skycap::missions::scan {

/// What a sensor is fixed to. Routes that say where a gimbal looks carry both.
enum class Carrier {
  airframe,  ///< stays level, with the heading of the route
  gimbal,    ///< looks where the camera of the route looks
};

struct ScanRoute {
  sim::Trajectory carrier;          ///< world_from_body; body: x forward, y left, z up
  std::vector<double> image_times;  ///< when a camera takes images; empty: the route does not say
};

/// Reads a route:
///  - .tum, .txt: `time x y z qx qy qz qw` of world_from_camera, which the carrier is fixed to, be
///    it a gimbal or not;
///  - .csv: a trajectory as written by flight/export/trajectory_file.h, or views as in views.csv;
///  - .plan, .waypoints, .kmz, .kml, .geojson, .json: the points of any file that flight/export
///    reads, by the options' site and pad, looking ahead;
///  - a folder: of the mission package in it the mission.csv, or mission-1.csv, mission-2.csv and
///    so on one after the other, or its views.csv if it is not flown.
/// Views and points are flown in order along straight lines at the options' speed, with turns
/// of 1 rad/s on the spot; an image is taken at each view. Throws Error{bad_file} in one line, and
/// Error{bad_config} if the file's places are on Earth and the options have no site.
ScanRoute read_scan_route(const std::filesystem::path& path, const FlownScanOptions& options,
                          Carrier carrier);

/// Circles at constant speed, level, nose in the direction of flight. Time starts at zero.
sim::Trajectory orbit_trajectory(const OrbitOptions& orbit);

/// body_from_camera of a camera that looks forward: its optical axis is the body's x.
Eigen::Isometry3d body_from_camera();

}  // namespace skycap::missions::scan
