/// Simulated scan with a laser scanner, recorded as a whole or in pieces. Private to
/// missions/cli/clouds.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flight/export/utm.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/commands.h"
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
  /// Reads the flight and the model; `index` is the tile index of a tiled model
  /// (scene::TiledScene). The arguments must outlive this object. Throws Error if a key, an option
  /// or a file is invalid.
  LaserScan(const ScanCommandOptions& options, const config::MissionSetup& setup,
            const config::SensorDescription& sensor, const Console& console,
            const std::filesystem::path& index = {});
  LaserScan(const LaserScan&) = delete;
  LaserScan& operator=(const LaserScan&) = delete;

  /// Records the whole flight and commits it to `folder`. Returns the exit code.
  int run(geometry::OutputFolder& folder);

  /// Records a piece into its own folder within the results, unless it is already complete there.
  /// Resumes an interrupted piece. Returns whether the piece is now complete.
  bool scan_shard(const scan::FlightShard& shard, const std::filesystem::path& results);

  /// Returns a piece from the results, if it is complete and belongs to this scan.
  std::optional<scan::CompletedShard> complete(const scan::FlightShard& shard,
                                               const std::filesystem::path& results) const;

  /// Joins all pieces into the complete scan and commits it. Returns the exit code.
  int join(std::span<const scan::CompletedShard> shards, geometry::OutputFolder& folder);

 private:
  nlohmann::ordered_json identity(const scan::FlightShard& shard) const;
  scene::SensedScene read_scene(const std::filesystem::path& index);
  /// Loads the scene for a piece.
  void prepare(const scan::FlightShard& shard);
  scan::LaserResult record(const scan::FlightShard& shard, scan::ScanJournal& journal,
                           const nlohmann::ordered_json& begun, geometry::OutputFolder& folder);
  int finish(const scan::LaserResult& recorded, geometry::OutputFolder& folder);
  nlohmann::ordered_json figures(const scan::LaserResult& recorded) const;
  void print(const scan::LaserResult& recorded, const std::filesystem::path& folder) const;
  double pulse_count(std::uint64_t firings) const;
  double to_seconds(std::uint64_t firings) const;

  const ScanCommandOptions& options_;
  const config::MissionSetup& setup_;
  const config::SensorDescription& sensor_;
  const Console& console_;
  sim::Lidar lidar_;
  scan::ScanFlight scan_flight_;
  sim::LidarFlight flight_;
  std::shared_ptr<const flight::UtmProjection> projection_;
  scan::PreviewSegments preview_;
  ProgressLine progress_;
  scene::SensedScene truth_;
  nlohmann::ordered_json identity_;  ///< all inputs that determine the scan
  std::optional<sim::Scene> scene_;  ///< for a tiled model, only the tiles of one piece
  std::vector<scan::LaserOutput> outputs_;
};

}  // namespace skycap::missions::cli
