/// A laser scanner's flight, measured as a whole or in pieces. For the sources of this room.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flight/export/utm.h"
#include "geometry/io/output_folder.h"
#include "missions/equipment/sensor_reader.h"
#include "missions/file/mission.h"
#include "missions/recording/laser_recorder.h"
#include "missions/recording/preview.h"
#include "missions/recording/scan_flight.h"
#include "missions/scene/sensed_scene.h"
#include "missions/verbs/verbs.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::verbs {

class LaserScan {
 public:
  /// Reads the flight and the model, of tiles with that `index` (scene::TiledScene). What is given
  /// must outlive it. Throws Error if a key, an option or a file is wrong.
  LaserScan(const ScanVerbOptions& options, const file::Mission& mission,
            const equipment::SensorDescription& sensor, const Console& console,
            const std::filesystem::path& index = {});
  LaserScan(const LaserScan&) = delete;
  LaserScan& operator=(const LaserScan&) = delete;

  /// Measures the whole flight into `folder` and commits; returns the exit code.
  int run(geometry::OutputFolder& folder);

  /// Measures a piece into its own folder among the results, unless it is complete there; what was
  /// interrupted is gone on with. Whether it is complete now.
  bool run_piece(const recording::FlightPiece& piece, const std::filesystem::path& results);

  /// A piece among the results, if it is complete and of this scan.
  std::optional<recording::CompletePiece> complete(const recording::FlightPiece& piece,
                                                   const std::filesystem::path& results) const;

  /// Makes the whole scan of all of its pieces and commits; returns the exit code.
  int join(std::span<const recording::CompletePiece> pieces, geometry::OutputFolder& folder);

 private:
  nlohmann::ordered_json identity(const recording::FlightPiece& piece) const;
  scene::SensedScene read_scene(const std::filesystem::path& index);
  /// Makes the scene ready for a piece.
  void prepare(const recording::FlightPiece& piece);
  recording::LaserResult record(const recording::FlightPiece& piece,
                                recording::ScanJournal& journal,
                                const nlohmann::ordered_json& begun,
                                geometry::OutputFolder& folder);
  int finish(const recording::LaserResult& recorded, geometry::OutputFolder& folder);
  nlohmann::ordered_json figures(const recording::LaserResult& recorded) const;
  void print(const recording::LaserResult& recorded, const std::filesystem::path& folder) const;
  double shots_of(std::uint64_t firings) const;
  double seconds_of(std::uint64_t firings) const;

  const ScanVerbOptions& options_;
  const file::Mission& mission_;
  const equipment::SensorDescription& sensor_;
  const Console& console_;
  sim::Lidar lidar_;
  recording::ScanFlight flown_;
  sim::LidarFlight flight_;
  std::shared_ptr<const flight::UtmProjection> projection_;
  recording::PreviewPieces preview_;
  ProgressLine progress_;
  scene::SensedScene truth_;
  nlohmann::ordered_json identity_;  ///< what decides the whole scan
  std::optional<sim::Scene> scene_;  ///< of tiles, those of one piece
  std::vector<recording::LaserOutput> outputs_;
};

}  // namespace skycap::missions::verbs
