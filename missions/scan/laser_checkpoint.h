/// How far the recording of a laser scanner had come, as its journal holds it.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "missions/scan/cloud_file.h"
#include "missions/scan/scan_runner.h"

namespace skycap::missions::scan {

struct LaserCheckpoint {
  ScanProgress progress;  ///< firings and points
  double time = 0.0;      ///< that the simulation took [s]
  std::vector<CloudState> files;
};

nlohmann::ordered_json json_of(const LaserCheckpoint& checkpoint);

/// Throws Error{bad_file}, beginning with `name`, unless json_of() has made it of so many files.
LaserCheckpoint parse_laser_checkpoint(const nlohmann::ordered_json& json, std::size_t files,
                                       const std::string& name);

}  // namespace skycap::missions::scan
