/// Flight of a mission's sensor during a scan: actual and estimated trajectory and mounting.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "missions/scan/scan_options.h"
#include "missions/scan/scan_route.h"
#include "sim/sensors/lidar.h"
#include "sim/sensors/trajectory.h"

namespace skycap::missions::scan {

/// Pose of the sensor on its platform (body_from_sensor): actual, and estimated by calibration.
struct Mount {
  Eigen::Isometry3d real, estimated;
};

struct ScanFlight {
  ScanRoute route;
  sim::Trajectory estimated;  ///< Trajectory of the platform as estimated by its navigation.
  Mount mount;

  /// Returns the flight of a laser scanner. It keeps references to this object.
  sim::LidarFlight lidar_flight() const {
    return {route.platform, estimated, mount.real, mount.estimated};
  }
};

/// Returns the flight along `route_file`, or along the options' route (relative to `folder`), or
/// along the options' orbit. `seed` is used for navigation errors. Throws all errors of
/// read_scan_route().
ScanFlight scan_flight(const ScanFlightOptions& options, std::uint64_t seed,
                       const std::filesystem::path& folder,
                       const std::optional<std::filesystem::path>& route_file, Platform platform);

/// Returns a checksum that identifies a flight. It covers the actual and estimated poses, both
/// mounts and the image times.
std::string compute_checksum(const ScanFlight& flight);

/// Part of a flight [s].
struct TimeSpan {
  double start, end;
};

/// Returns a conservative test for boxes. The result is false only if a sensor with this range
/// cannot observe the box from any position in `span`.
std::function<bool(const Eigen::AlignedBox3d& box)> within_reach(const ScanFlight& flight,
                                                                 const TimeSpan& span,
                                                                 double range);

/// Throws Error{bad_config} if the scan has too many firings to be simulated.
void require_measurable(const sim::Lidar& lidar, const sim::Trajectory& ground_truth);

}  // namespace skycap::missions::scan
