/// Journal checkpoint of a laser scanner's recording.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "missions/scan/cloud_file.h"
#include "missions/scan/scan_runner.h"

namespace skycap::missions::scan {

struct LaserCheckpoint {
  ScanProgress progress;  ///< Completed firings and points.
  double time = 0.0;      ///< Computation time [s].
  std::vector<CloudState> files;
};

nlohmann::ordered_json to_json(const LaserCheckpoint& checkpoint);

/// Restores a checkpoint from to_json(). Throws Error{bad_file} with the prefix `name` if the JSON
/// is invalid or has another number of files.
LaserCheckpoint parse_laser_checkpoint(const nlohmann::ordered_json& json, std::size_t files,
                                       const std::string& name);

}  // namespace skycap::missions::scan
