/// The files of a laser scanner's flight, which an interrupted recording can be gone on with.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "geometry/io/output_folder.h"
#include "missions/recording/cloud_file.h"
#include "missions/recording/scan_journal.h"
#include "missions/recording/scan_runner.h"

namespace skycap::missions::recording {

/// A file to be written, and how large it became: with nothing in it it is left out.
struct LaserOutput {
  std::string name;
  std::shared_ptr<const CloudFormat> format;
  ReturnPosition position = ReturnPosition::reported;
  std::uint64_t bytes = 0;
};

struct LaserResult {
  ScanResult scan;
  double time = 0.0;  ///< that it took, all runs together [s]
};

/// Measures the flight into `journal`, going on from `begun` (its last checkpoint, or null), and
/// stages the outputs in `folder`, whose caller commits. Throws what run_scan() does, and
/// Error{bad_file} if a file cannot be written or `begun` is of other files.
LaserResult record_laser(const sim::Scene& scene, const sim::Lidar& lidar,
                         const sim::LidarFlight& flight, std::span<LaserOutput> outputs,
                         ScanJournal& journal, const nlohmann::ordered_json& begun,
                         geometry::OutputFolder& folder, ScanOptions options);

}  // namespace skycap::missions::recording
