/// A whole flight of a laser scanner, measured on all cores and handed on piece by piece.
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
  std::uint64_t firings = 0;      ///< where in the flight: measured and written up to here
  std::uint64_t all_firings = 0;  ///< of the flight
  std::uint64_t points = 0;
};

struct ScanResult {
  ScanProgress progress;
  bool is_complete = false;  ///< false: it was stopped
};

/// One of the pieces that a flight is measured in, perhaps by different programs.
struct FlightPiece {
  std::size_t number = 0;  ///< from 0 on
  std::size_t count = 1;   ///< of all
};

/// The firings of a piece: those of all pieces are all of the flight's, in about equal shares.
/// Written one behind the other, they give the bytes of the whole flight in every format.
sim::FiringRange firings_of(const FlightPiece& piece, const sim::Lidar& lidar,
                            const sim::Trajectory& flown);

struct ScanOptions {
  unsigned threads = 0;  ///< zero: all processors
  FlightPiece piece;     ///< which is measured
  ScanProgress begun;    ///< what the files hold already, of a checkpoint; no firings: nothing
  /// Called from one thread at a time, `checkpoint_period` after the last time or later, when the
  /// files hold all of the progress and no more; may be empty.
  std::function<void(const ScanProgress&)> checkpoint;
  double checkpoint_period = 5.0;  ///< [s]
  /// Called now and then, from one thread at a time; may be empty.
  std::function<void(const ScanProgress&)> report;
  std::stop_token stop;
};

/// Measures a piece of `flight`, or what is left of it, and appends the returns to each of `files`,
/// which the caller finishes, in the order of the shots. Throws Error{bad_file} if no checkpoint
/// was where options.begun is. The bytes do not depend on the number of threads, and the
/// memory that is needed does not on the length of the flight.
ScanResult run_scan(const sim::Scene& scene, const sim::Lidar& lidar,
                    const sim::LidarFlight& flight, std::span<CloudFile> files,
                    const ScanOptions& options);

}  // namespace skycap::missions::scan
