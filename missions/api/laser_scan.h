/// The flight of a laser scanner over a mission's scene, measured piece by piece: the points that
/// `skycap scan` writes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "missions/api/mission.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::api {

/// What takes the place of the mission's.
struct ScanRequest {
  std::optional<std::string> sensor;           ///< a preset's name, or a description's path
  std::optional<std::filesystem::path> route;  ///< any file that `skycap scan --route` takes
};

/// Needs memory for a piece, however long the flight.
class LaserScan {
 public:
  /// Throws Error{bad_config} if the sensor is a camera, and what is wrong with scene, sensor or
  /// route.
  LaserScan(const Mission& mission, const ScanRequest& request);
  ~LaserScan();

  /// The next returns in the order in which they were measured, in parts; nothing when the flight
  /// is over. Valid until the next call. They do not depend on the number of threads.
  std::span<const sim::LidarReturns> next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< the name in programs of users
}
