#include "missions/recording/laser_recorder.h"

#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "missions/recording/laser_checkpoint.h"

namespace skycap::missions::recording {
namespace {

using Clock = std::chrono::steady_clock;

/// New files, or those of the checkpoint as they were then.
std::vector<CloudFile> open_files(std::span<const LaserOutput> outputs, const ScanJournal& journal,
                                  const LaserCheckpoint& begun) {
  std::vector<CloudFile> files;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto grown = begun.files.empty() ? std::nullopt : std::optional(begun.files[i]);
    files.emplace_back(journal.path_to_change(outputs[i].name), outputs[i].format,
                       outputs[i].position, grown);
  }
  return files;
}

}  // namespace

LaserResult record_laser(const sim::Scene& scene, const sim::Lidar& lidar,
                         const sim::LidarFlight& flight, std::span<LaserOutput> outputs,
                         ScanJournal& journal, const nlohmann::ordered_json& begun,
                         geometry::OutputFolder& folder, ScanOptions options) {
  LaserCheckpoint reached;
  if (begun.is_object()) {
    reached = parse_laser_checkpoint(begun, outputs.size(), journal.file().string());
  }
  std::vector<CloudFile> files = open_files(outputs, journal, reached);
  const Clock::time_point start = Clock::now();
  const double earlier = reached.time;
  const auto write_down = [&](const ScanProgress& progress) {
    reached = {progress, earlier + std::chrono::duration<double>(Clock::now() - start).count(), {}};
    for (const CloudFile& file : files) {
      file.sync();
      reached.files.push_back(file.state());
    }
    journal.checkpoint(json_of(reached));
  };
  options.begun = reached.progress;
  options.checkpoint = write_down;
  const ScanResult result = run_scan(scene, lidar, flight, files, options);
  write_down(result.progress);
  for (std::size_t i = 0; i < files.size(); ++i) {
    files[i].finish();
    outputs[i].bytes = files[i].bytes();
    // A rawlog without an observation is none.
    if (outputs[i].bytes > 0) journal.stage(outputs[i].name, folder);
  }
  return {result, reached.time};
}

}  // namespace skycap::missions::recording
