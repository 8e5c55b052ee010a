/// Recording of a laser scanner's flight to files. An interrupted recording can be resumed, and
/// pieces of a flight can be recorded separately and joined.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "geometry/io/output_folder.h"
#include "missions/scan/cloud_file.h"
#include "missions/scan/laser_checkpoint.h"
#include "missions/scan/scan_journal.h"
#include "missions/scan/scan_runner.h"

namespace skycap::missions::scan {

/// Output file and its final size. Empty files are not written.
struct LaserOutput {
  std::string name;
  std::shared_ptr<const CloudFormat> format;
  ReturnPosition position = ReturnPosition::reported;
  std::uint64_t bytes = 0;
};

struct LaserResult {
  ScanResult scan;
  /// State at the end of the scan, with the computation time of all runs and the outputs before
  /// finishing.
  LaserCheckpoint reached;
};

/// Records the flight, or the piece options.piece of it, with `journal` and stages the outputs in
/// `folder`; the caller commits. `begun` is the last checkpoint of the journal, or null. Throws all
/// errors of run_scan(). Throws Error{bad_file} if a file cannot be written or `begun` refers to
/// other files.
LaserResult record_laser(const sim::Scene& scene, const sim::Lidar& lidar,
                         const sim::LidarFlight& flight, std::span<LaserOutput> outputs,
                         ScanJournal& journal, const nlohmann::ordered_json& begun,
                         geometry::OutputFolder& folder, ScanOptions options);

/// File that marks a piece as complete. It contains the identity of the piece and the extents of
/// its files.
inline constexpr const char* shard_file_name = "piece.json";

/// Returns the contents of piece.json. `identity` identifies the piece (support::identity_text()).
std::string completed_shard_text(const std::string& identity, const LaserCheckpoint& reached);

/// Returns the final state of the piece in `folder`. Returns an empty value if it is incomplete, or
/// has another identity or number of files.
std::optional<LaserCheckpoint> read_completed_shard(const std::filesystem::path& folder,
                                                    const std::string& identity, std::size_t files);

/// Complete piece of a flight.
struct CompletedShard {
  std::filesystem::path folder;
  LaserCheckpoint checkpoint;
};

/// Joins all pieces in order and stages the outputs in `folder`. The outputs equal those of
/// record_laser() for the whole flight. Throws Error{bad_file} if a file cannot be read or written.
LaserResult join_shards(std::span<const CompletedShard> shards, std::span<LaserOutput> outputs,
                        geometry::OutputFolder& folder);

}  // namespace skycap::missions::scan
