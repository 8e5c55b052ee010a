#include "missions/scan/laser_recorder.h"

#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "missions/support/json_text.h"

namespace skycap::missions::scan {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

/// Opens new files, or those of the checkpoint with their extents at that time.
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
    journal.checkpoint(to_json(reached));
  };
  options.begun = reached.progress;
  options.checkpoint = write_down;
  const ScanResult result = run_scan(scene, lidar, flight, files, options);
  write_down(result.progress);
  for (std::size_t i = 0; i < files.size(); ++i) {
    files[i].finish();
    outputs[i].bytes = files[i].bytes();
    // A rawlog without observations is not valid.
    if (outputs[i].bytes > 0) journal.stage(outputs[i].name, folder);
  }
  return {result, std::move(reached)};
}

std::string completed_shard_text(const std::string& identity, const LaserCheckpoint& reached) {
  return support::json_text({{"of", identity}, {"holds", to_json(reached)}});
}

std::optional<LaserCheckpoint> read_completed_shard(const fs::path& folder,
                                                    const std::string& identity,
                                                    std::size_t files) {
  const fs::path file = folder / shard_file_name;
  std::error_code missing;
  if (!fs::is_regular_file(file, missing)) return std::nullopt;
  try {
    const Json shard = geometry::parse_json<Json>(geometry::read_file(file));
    if (shard.at("of") != Json(identity)) return std::nullopt;
    return parse_laser_checkpoint(shard.at("holds"), files, file.string());
  } catch (const Json::exception&) {
    return std::nullopt;
  } catch (const Error&) {  // The piece will be measured again.
    return std::nullopt;
  }
}

LaserResult join_shards(std::span<const CompletedShard> shards, std::span<LaserOutput> outputs,
                        geometry::OutputFolder& folder) {
  LaserResult result;
  for (const CompletedShard& shard : shards) {
    result.reached.progress.firings = shard.checkpoint.progress.firings;
    result.reached.progress.points += shard.checkpoint.progress.points;
    result.reached.time += shard.checkpoint.time;
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    LaserOutput& output = outputs[i];
    CloudFile file(folder.stage(output.name), output.format, output.position);
    for (const CompletedShard& shard : shards) {
      file.append_file(shard.folder / output.name, shard.checkpoint.files[i]);
    }
    result.reached.files.push_back(file.state());
    file.finish();
    output.bytes = file.bytes();
    if (output.bytes == 0) folder.drop(output.name);
  }
  result.scan = {result.reached.progress, true};
  return result;
}

}  // namespace skycap::missions::scan
