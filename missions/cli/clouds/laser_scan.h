/// A laser scanner's flight, measured as a whole or in pieces. For the sources of this room.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flight/export/utm.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/verbs.h"
#include "missions/config/mission_setup.h"
#include "missions/config/sensor_reader.h"
#include "missions/scan/laser_recorder.h"
#include "missions/scan/preview.h"
#include "missions/scan/scan_flight.h"
#include "missions/scene/sensed_scene.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::cli {

class LaserScan {
 public:
  /// Reads the flight and the model, of tiles with that `index` (scene::TiledScene). What is given
  /// must outlive it. Throws Error if a key, an option or a file is wrong.
  LaserScan(const ScanVerbOptions& options, const config::MissionSetup& setup,
            const config::SensorDescription& sensor, const Console& console,
            const std::filesystem::path& index = {});
  LaserScan(const LaserScan&) = delete;
  LaserScan& operator=(const LaserScan&) = delete;

  /// Measures the whole flight into `folder` and commits; returns the exit code.
  int run(geometry::OutputFolder& folder);

  /// Measures a piece into its own folder among the results, unless it is complete there; what was
  /// interrupted is gone on with. Whether it is complete now.
  bool run_piece(const scan::FlightPiece& piece, const std::filesystem::path& results);

  /// A piece among the results, if it is complete and of this scan.
  std::optional<scan::CompletePiece> complete(const scan::FlightPiece& piece,
                                              const std::filesystem::path& results) const;

  /// Makes the whole scan of all of its pieces and commits; returns the exit code.
  int join(std::span<const scan::CompletePiece> pieces, geometry::OutputFolder& folder);

 private:
  nlohmann::ordered_json identity(const scan::FlightPiece& piece) const;
  scene::SensedScene read_scene(const std::filesystem::path& index);
  /// Makes the scene ready for a piece.
  void prepare(const scan::FlightPiece& piece);
  scan::LaserResult record(const scan::FlightPiece& piece, scan::ScanJournal& journal,
                           const nlohmann::ordered_json& begun, geometry::OutputFolder& folder);
  int finish(const scan::LaserResult& recorded, geometry::OutputFolder& folder);
  nlohmann::ordered_json figures(const scan::LaserResult& recorded) const;
  void print(const scan::LaserResult& recorded, const std::filesystem::path& folder) const;
  double shots_of(std::uint64_t firings) const;
  double seconds_of(std::uint64_t firings) const;

  const ScanVerbOptions& options_;
  const config::MissionSetup& setup_;
  const config::SensorDescription& sensor_;
  const Console& console_;
  sim::Lidar lidar_;
  scan::ScanFlight flown_;
  sim::LidarFlight flight_;
  std::shared_ptr<const flight::UtmProjection> projection_;
  scan::PreviewPieces preview_;
  ProgressLine progress_;
  scene::SensedScene truth_;
  nlohmann::ordered_json identity_;  ///< what decides the whole scan
  std::optional<sim::Scene> scene_;  ///< of tiles, those of one piece
  std::vector<scan::LaserOutput> outputs_;
};

}  // namespace skycap::missions::cli
