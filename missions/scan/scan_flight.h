/// How a mission's sensor is carried while it scans, and how its carrier believes that it is.
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

/// body_from_sensor: how the sensor sits on its carrier, and how the calibration says that it does.
struct Mount {
  Eigen::Isometry3d real, believed;
};

struct ScanFlight {
  ScanRoute route;
  sim::Trajectory believed;  ///< of the carrier, by its navigation
  Mount mount;

  /// The same for a laser scanner. Keeps references to this object.
  sim::LidarFlight of_scanner() const {
    return {route.carrier, believed, mount.real, mount.believed};
  }
};

/// The flight of `route_file`, else of the options' route, which is relative to `folder`, else of
/// their orbit. The seed is that of the navigation's errors. Throws what read_scan_route() throws.
ScanFlight scan_flight(const FlownScanOptions& options, std::uint64_t seed,
                       const std::filesystem::path& folder,
                       const std::optional<std::filesystem::path>& route_file, Carrier carrier);

/// Tells it from other flights: a checksum of its poses, as they are and as they are believed to
/// be, of both mounts and of the times of images.
std::string digest_of(const ScanFlight& flight);

/// Part of a flight [s].
struct TimeSpan {
  double start, end;
};

/// Whether a sensor of that range could see into a box from somewhere on that part of a flight:
/// surely not, if it says so.
std::function<bool(const Eigen::AlignedBox3d& box)> within_reach(const ScanFlight& flight,
                                                                 const TimeSpan& span,
                                                                 double range);

/// Throws Error{bad_config} for what no scan would ever finish.
void require_measurable(const sim::Lidar& lidar, const sim::Trajectory& flown);

}  // namespace skycap::missions::scan
