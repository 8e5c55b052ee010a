/// Multithreaded simulation of a whole flight of a laser scanner, with output in small portions.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "missions/scan/cloud_file.h"
#include "sim/scene/scene.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::scan {

struct ScanProgress {
  std::uint64_t firings = 0;      ///< Number of firings that have been measured and written.
  std::uint64_t all_firings = 0;  ///< Total number of firings of the flight.
  std::uint64_t points = 0;
};

struct ScanResult {
  ScanProgress progress;
  bool is_complete = false;  ///< False if a stop request ended the scan.
};

/// Piece of a flight. Pieces can be measured by separate processes.
struct FlightShard {
  std::size_t number = 0;  ///< Index from 0.
  std::size_t count = 1;   ///< Number of pieces of the flight.
};

/// Returns the firings of a piece. Pieces have approximately equal sizes and cover the whole
/// flight. In all formats, the concatenated pieces have the bytes of the whole flight.
sim::FiringRange find_firings(const FlightShard& shard, const sim::Lidar& lidar,
                              const sim::Trajectory& ground_truth);

struct ScanOptions {
  unsigned threads = 0;  ///< Number of threads (0: all processors).
  FlightShard shard;     ///< Piece to measure.
  ScanProgress begun;    ///< Checkpoint to resume from; without firings, a new scan starts.
  /// Called at intervals of at least `checkpoint_period`, never concurrently. The files then
  /// contain exactly the data up to the progress. May be empty.
  std::function<void(const ScanProgress&)> checkpoint;
  double checkpoint_period = 5.0;  ///< Minimum interval between checkpoints [s].
  /// Called repeatedly with the progress, never concurrently; may be empty.
  std::function<void(const ScanProgress&)> report;
  std::stop_token stop;
};

/// Measures the whole or remaining piece of `flight` and appends the returns to each file in pulse
/// order. The caller finishes the files. Throws Error{bad_file} if options.begun does not match a
/// possible checkpoint. The output does not depend on the number of threads, and the memory usage
/// does not depend on the length of the flight.
ScanResult run_scan(const sim::Scene& scene, const sim::Lidar& lidar,
                    const sim::LidarFlight& flight, std::span<CloudFile> files,
                    const ScanOptions& options);

}  // namespace skycap::missions::scan
