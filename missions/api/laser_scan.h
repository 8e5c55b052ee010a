/// Simulated laser scan of a mission's scene in pieces, with the same points as `skycap scan`.
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

/// Overrides of the mission's scan settings.
struct ScanRequest {
  std::optional<std::string> sensor;  ///< name of a preset, or path of a sensor description
  std::optional<std::filesystem::path> route;  ///< any file accepted by `skycap scan --route`
};

/// Scan iterator. Its memory use does not depend on the length of the flight.
class LaserScan {
 public:
  /// Prepares the scan. Throws Error{bad_config} if the sensor is a camera, and Error for an
  /// invalid scene, sensor or route.
  LaserScan(const Mission& mission, const ScanRequest& request);
  ~LaserScan();

  /// Returns the next returns in chronological order, divided into parts, or an empty span at the
  /// end of the flight. The span is valid until the next call. The returns do not depend on the
  /// number of threads.
  std::span<const sim::LidarReturns> next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< public name for user programs
}
