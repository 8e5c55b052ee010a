/// The files of a laser scanner's flight, which an interrupted recording can be gone on with, and
/// which may be made of pieces of the flight that were recorded one by one.
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

/// A file to be written, and how large it became: with nothing in it it is left out.
struct LaserOutput {
  std::string name;
  std::shared_ptr<const CloudFormat> format;
  ReturnPosition position = ReturnPosition::reported;
  std::uint64_t bytes = 0;
};

struct LaserResult {
  ScanResult scan;
  /// Where the scan is at its end, with the time that it took, all runs together, and with the
  /// outputs as they were before they were finished.
  LaserCheckpoint reached;
};

/// Measures the flight, or the piece of options.piece, into `journal`, going on from `begun` (its
/// last checkpoint, or null), and stages the outputs in `folder`, whose caller commits. Throws what
/// run_scan() does, and Error{bad_file} if a file cannot be written or `begun` is of other files.
LaserResult record_laser(const sim::Scene& scene, const sim::Lidar& lidar,
                         const sim::LidarFlight& flight, std::span<LaserOutput> outputs,
                         ScanJournal& journal, const nlohmann::ordered_json& begun,
                         geometry::OutputFolder& folder, ScanOptions options);

/// The file that makes a piece complete: what it is of, and what its other files hold.
inline constexpr const char* piece_name = "piece.json";

/// The text of piece_name. `identity` is what decides the piece (support::identity_text()).
std::string piece_text(const std::string& identity, const LaserCheckpoint& reached);

/// What a piece that is complete and of that identity holds in so many files; nothing without one.
std::optional<LaserCheckpoint> complete_piece(const std::filesystem::path& folder,
                                              const std::string& identity, std::size_t files);

/// A piece that is complete.
struct CompletePiece {
  std::filesystem::path folder;
  LaserCheckpoint holds;
};

/// Makes the outputs of the whole flight, as record_laser() would have, of all of its pieces in
/// their order, and stages them in `folder`. Throws Error{bad_file} if a file cannot be read or
/// written.
LaserResult join_pieces(std::span<const CompletePiece> pieces, std::span<LaserOutput> outputs,
                        geometry::OutputFolder& folder);

}  // namespace skycap::missions::scan
