#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "missions/cli/clouds/camera_scan.h"
#include "missions/cli/clouds/laser_scan.h"
#include "missions/cli/clouds/scan_results.h"
#include "missions/cli/commands.h"
#include "missions/cli/tasks.h"
#include "missions/config/preset_files.h"
#include "missions/config/resolve.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

class FlightShards final : public ShardedJob {
 public:
  FlightShards(const ScanCommandOptions& options, const config::MissionSetup& setup,
               const config::SensorDescription& sensor, const fs::path& out, const Console& console)
      : scan_(options, setup, sensor, console, shards_folder(out) / "tiles.json"),
        shards_(options.shards),
        out_(out) {}

  bool process_shard(std::size_t number) override {
    return scan_.scan_shard({number, shards_}, out_);
  }

  bool load_shard(std::size_t number) override {
    auto shard = scan_.complete({number, shards_}, out_);
    if (!shard) return false;
    complete_.push_back(std::move(*shard));
    return true;
  }

  int join(geometry::OutputFolder& folder) override { return scan_.join(complete_, folder); }

 private:
  LaserScan scan_;
  std::size_t shards_;
  fs::path out_;
  std::vector<scan::CompletedShard> complete_;
};

/// Returns the command that repeats this scan as a task.
batch::Words make_command(const ScanCommandOptions& options, const fs::path& out) {
  batch::Words words{"scan",     fs::absolute(options.mission), "--out", fs::absolute(out),
                     "--pieces", std::to_string(options.shards)};
  const auto add = [&](const std::string& option, const std::string& value) {
    words.insert(words.end(), {option, value});
  };
  if (options.route) add("--route", fs::absolute(*options.route));
  if (options.sensor) {
    const bool is_file = options.sensor->ends_with(".yaml");
    add("--sensor", is_file ? fs::absolute(*options.sensor).string() : *options.sensor);
  }
  add("--format", fmt::format("{}", fmt::join(options.formats, ",")));
  if (options.with_truth) words.emplace_back("--with-truth");
  if (!options.has_report) words.emplace_back("--no-report");
  for (const config::KeyOverride& key : options.overrides) {
    // Tasks set their own number of threads.
    if (key.path != "threads") add("--set", key.path + "=" + key.value);
  }
  return words;
}

int scan_in_shards(const ScanCommandOptions& options, const config::MissionSetup& setup,
                   const config::SensorDescription& sensor, const fs::path& out,
                   const Console& console) {
  const batch::JobRequest job{.command = make_command(options, out),
                              .out = out,
                              .title = "Scan " + setup.name,
                              .name = setup.name,
                              .items = options.shards,
                              .jobs = geometry::thread_count(setup.run.threads)};
  return run_shards(
      job, options.task, options.is_quiet, scan_name,
      [&] { return std::make_unique<FlightShards>(options, setup, sensor, out, console); },
      console);
}

config::SensorDescription make_sensor(const ScanCommandOptions& options,
                                      const scan::ScanFlightOptions& scan) {
  return config::find_sensor(
      options.sensor.value_or(config::named_from(options.mission.parent_path(), scan.sensor)));
}

}  // namespace

int scan(const ScanCommandOptions& options, const Console& console) {
  const config::MissionSetup setup = read_shown(config::read_mission, options, console);
  const config::SensorDescription sensor = make_sensor(options, setup.scan);
  const fs::path out = options.out.value_or(fs::path("results") / setup.name / "scan");
  const bool is_laser = std::holds_alternative<sim::LidarConfig>(sensor.sensor);
  if (options.shards > 0) {
    if (!is_laser) {
      throw Error(
          ErrorKind::bad_usage,
          "--pieces: " + sensor.name + " is a camera; only scans of laser scanners can be split");
    }
    return scan_in_shards(options, setup, sensor, out, console);
  }
  if (options.task.is_set()) {
    throw Error(ErrorKind::bad_usage, "--index, --chunk, --collect and --submit require --pieces");
  }
  geometry::OutputFolder folder(out);
  if (!is_laser) return scan_with_camera(options, setup, sensor, folder, console);
  return LaserScan(options, setup, sensor, console).run(folder);
}

}  // namespace skycap::missions::cli
