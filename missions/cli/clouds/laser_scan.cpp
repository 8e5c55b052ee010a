#include "missions/cli/clouds/laser_scan.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/export/trajectory_file.h"
#include "geometry/error.h"
#include "missions/cli/clouds/scan_results.h"
#include "missions/cli/tasks.h"
#include "missions/cli/write_page.h"
#include "missions/package/settings.h"
#include "missions/scan/cloud_formats.h"
#include "missions/support/journal_text.h"
#include "missions/support/json_text.h"

namespace skycap::missions::cli {
namespace {

using Eigen::Isometry3d;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

sim::LidarConfig seeded(sim::LidarConfig config, std::uint64_t seed) {
  config.seed = seed;
  return config;
}

std::shared_ptr<const flight::UtmProjection> make_projection(const scan::ScanFlightOptions& scan) {
  if (scan.crs == scan::ScanCrs::local) return nullptr;
  if (!scan.site) {
    throw Error(ErrorKind::bad_config,
                "scan.crs: utm requires a georeference; set site.latitude_deg and "
                "site.longitude_deg, or use local");
  }
  return std::make_shared<const flight::UtmProjection>(*scan.site);
}

/// Returns the sensor's poses as a TUM file, up to the first pose at or after `end` [s].
std::string sensor_tum(const sim::Trajectory& platform, const Isometry3d& body_from_sensor,
                       double end) {
  std::vector<flight::TimedPose> poses;
  for (const sim::StampedPose& pose : platform.poses()) {
    poses.push_back({pose.time, platform.pose(pose.time) * body_from_sensor});
    if (pose.time >= end) break;
  }
  return flight::write_tum(poses);
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Shows the progress of a scan, at most ten times a second.
class ScanReport {
 public:
  ScanReport(ProgressLine& line, std::string name, double pulses_per_firing,
             const sim::FiringRange& range)
      : line_(line), name_(std::move(name)), pulses_per_firing_(pulses_per_firing), range_(range) {}

  void operator()(const scan::ScanProgress& progress) {
    const Clock::time_point now = Clock::now();
    if (now - shown_ < std::chrono::milliseconds(100)) return;
    shown_ = now;
    const auto measured_firings = static_cast<double>(progress.firings - range_.first);
    const auto all = static_cast<double>(range_.count);
    std::string text =
        fmt::format("{}: {:.1f}% flown, {:.1f} M points", name_, 100.0 * measured_firings / all,
                    1e-6 * static_cast<double>(progress.points));
    if (begun_) {
      const double rate = (measured_firings - *begun_) / seconds_since(start_);
      text += fmt::format(", {:.1f} M pulses/s, {:.0f} s left", 1e-6 * pulses_per_firing_ * rate,
                          (all - measured_firings) / rate);
    } else {  // the pace is not yet known
      begun_ = measured_firings;
      start_ = now;
    }
    line_.show(text);
  }

 private:
  ProgressLine& line_;
  std::string name_;
  double pulses_per_firing_;
  sim::FiringRange range_;       ///< firings of the scan
  std::optional<double> begun_;  ///< completed firings at the first report
  Clock::time_point start_, shown_;
};

std::vector<scan::LaserOutput> output_files(const ScanCommandOptions& options,
                                            const scan::CloudFormatContext& context) {
  std::vector<scan::LaserOutput> outputs;
  const auto add = [&](const std::string& name, const auto& format, scan::ReturnPosition position) {
    for (const scan::LaserOutput& output : outputs) {
      if (output.name == name) {
        throw Error(ErrorKind::bad_usage, "--format conflicts: two formats use the file name " +
                                              name + "; remove one of them");
      }
    }
    outputs.push_back({name, format, position});
  };
  for (const std::string& name : options.formats) {
    const scan::CloudFormatInfo& info = scan::cloud_format_named(name);
    const std::shared_ptr<const scan::CloudFormat> format = info.make(context);
    add("scan" + info.extension, format, scan::ReturnPosition::reported);
    if (options.with_truth) add("scan_true" + info.extension, format, scan::ReturnPosition::actual);
  }
  return outputs;
}

}  // namespace

LaserScan::LaserScan(const ScanCommandOptions& options, const config::MissionSetup& setup,
                     const config::SensorDescription& sensor, const Console& console,
                     const std::filesystem::path& index)
    : options_(options),
      setup_(setup),
      sensor_(sensor),
      console_(console),
      lidar_(seeded(std::get<sim::LidarConfig>(sensor.sensor), setup.run.seed)),
      scan_flight_(make_scan_flight(options, setup.scan, setup.run.seed, scan::Platform::airframe)),
      flight_(scan_flight_.lidar_flight()),
      projection_(make_projection(setup.scan)),
      preview_(scan::make_preview_segments(lidar_.config(), scan_flight_.route.platform)),
      progress_(console, options.is_quiet),
      truth_(read_scene(index)) {
  outputs_ =
      output_files(options, {sensor.name, lidar_.config(), flight_, truth_.centre(), projection_});
  identity_ = make_identity(sensor, truth_, scan_flight_);
  identity_.update({{"formats", options.formats}, {"truth", options.with_truth}});
  const double pulses = pulse_count(lidar_.firings(scan_flight_.route.platform));
  outputs_.push_back(
      {scan::preview_name, scan::preview_format(preview_, scan::preview_share(pulses))});
}

double LaserScan::pulse_count(std::uint64_t firings) const {
  return static_cast<double>(lidar_.config().channels.size()) * static_cast<double>(firings);
}

double LaserScan::to_seconds(std::uint64_t firings) const {
  return static_cast<double>(firings) * lidar_.config().firing_period;
}

Json LaserScan::identity(const scan::FlightShard& shard) const {
  Json all = identity_;
  all.update({{"piece", shard.number}, {"pieces", shard.count}});
  return all;
}

scene::SensedScene LaserScan::read_scene(const std::filesystem::path& index) {
  scan::require_measurable(lidar_, scan_flight_.route.platform);
  progress_.show(setup_.name + ": loading scene");
  return {setup_.scene(), options_.mission.parent_path(), setup_.run.threads, index};
}

void LaserScan::prepare(const scan::FlightShard& shard) {
  if (scene_ && !truth_.is_tiled()) return;
  scene_.reset();  // frees memory before loading the next scene
  const sim::FiringRange range = find_firings(shard, lidar_, scan_flight_.route.platform);
  const double start = scan_flight_.route.platform.start();
  const scan::TimeSpan span{start + to_seconds(range.first),
                            start + to_seconds(range.first + range.count)};
  scene_ = truth_.scene(setup_.run.threads,
                        scan::within_reach(scan_flight_, span, lidar_.config().max_range));
}

scan::LaserResult LaserScan::record(const scan::FlightShard& shard, scan::ScanJournal& journal,
                                    const Json& begun, geometry::OutputFolder& folder) {
  const sim::FiringRange range = find_firings(shard, lidar_, scan_flight_.route.platform);
  return record_laser(*scene_, lidar_, flight_, outputs_, journal, begun, folder,
                      {.threads = setup_.run.threads,
                       .shard = shard,
                       .report = ScanReport(progress_, setup_.name, pulse_count(1), range),
                       .stop = console_.stop});
}

int LaserScan::run(geometry::OutputFolder& folder) {
  prepare({});
  const PendingResultsGuard results(console_);
  scan::ScanJournal journal(folder.path());
  const Json begun =
      open_journal(journal, options_.resumes, options_, setup_.identity(), identity_, console_);
  const scan::LaserResult recorded = record({}, journal, begun, folder);
  const int exit_code = finish(recorded, folder);
  if (recorded.scan.is_complete) journal.close();
  return exit_code;
}

bool LaserScan::scan_shard(const scan::FlightShard& shard, const std::filesystem::path& results) {
  geometry::OutputFolder folder(shard_folder(results, shard.number, shard.count));
  if (complete(shard, results)) return true;
  prepare(shard);
  const PendingResultsGuard holds(console_);
  scan::ScanJournal journal(folder.path());
  const bool resumes = journal.matches_run(setup_.identity(), identity(shard));
  const Json begun =
      open_journal(journal, resumes, options_, setup_.identity(), identity(shard), console_);
  const scan::LaserResult recorded = record(shard, journal, begun, folder);
  progress_.clear();
  if (!recorded.scan.is_complete) return false;
  folder.replace([](std::string_view name) {
    return !name.starts_with(".") && name != scan::ScanJournal::folder_name;
  });
  folder.write(scan::shard_file_name,
               scan::completed_shard_text(
                   support::identity_text(setup_.identity(), identity(shard)), recorded.reached));
  folder.commit();
  journal.close();
  return true;
}

std::optional<scan::CompletedShard> LaserScan::complete(
    const scan::FlightShard& shard, const std::filesystem::path& results) const {
  const std::filesystem::path folder = shard_folder(results, shard.number, shard.count);
  auto holds = scan::read_completed_shard(
      folder, support::identity_text(setup_.identity(), identity(shard)), outputs_.size());
  if (!holds) return std::nullopt;
  return scan::CompletedShard{folder, std::move(*holds)};
}

int LaserScan::join(std::span<const scan::CompletedShard> shards, geometry::OutputFolder& folder) {
  const PendingResultsGuard results(console_);
  progress_.show(setup_.name + ": merging the pieces");
  return finish(join_shards(shards, outputs_, folder), folder);
}

int LaserScan::finish(const scan::LaserResult& recorded, geometry::OutputFolder& folder) {
  std::erase_if(outputs_, [](const auto& output) { return output.bytes == 0; });
  const bool is_complete = recorded.scan.is_complete;
  const sim::Trajectory& platform = scan_flight_.route.platform;
  const double end =
      is_complete ? platform.end() : platform.start() + to_seconds(recorded.scan.progress.firings);
  folder.write("trajectory.tum", sensor_tum(platform, scan_flight_.mount.real, end));
  folder.write("trajectory_estimated.tum",
               sensor_tum(scan_flight_.estimated, scan_flight_.mount.estimated, end));
  folder.write(scan_name, support::json_text(figures(recorded)));
  write_page(scan_name, options_.has_report, folder, console_);
  commit_scan(folder, is_complete);
  progress_.clear();
  if (!options_.is_quiet) print(recorded, folder.path());
  return is_complete ? 0 : 1;
}

Json LaserScan::figures(const scan::LaserResult& recorded) const {
  Json files = Json::array();
  for (const scan::LaserOutput& file : outputs_) {
    files.push_back({{"name", file.name}, {"bytes", file.bytes}});
  }
  const sim::NavigationErrors& navigation = setup_.scan.navigation;
  return {{"mission", setup_.name},
          {"sensor", sensor_.name},
          {"seed", setup_.run.seed},
          {"complete", recorded.scan.is_complete},
          {"flight_s", to_seconds(recorded.scan.progress.firings)},
          {"shots", static_cast<std::uint64_t>(pulse_count(recorded.scan.progress.firings))},
          {"points", recorded.scan.progress.points},
          {"las_crs", setup_.scan.crs == scan::ScanCrs::utm ? "utm" : "local"},
          {"simulation_s", recorded.reached.time},
          {"navigation",
           {{"horizontal_sigma_m", navigation.horizontal_sigma},
            {"vertical_sigma_m", navigation.vertical_sigma},
            {"tilt_sigma_rad", navigation.tilt_sigma},
            {"heading_sigma_rad", navigation.heading_sigma},
            {"correlation_time_s", navigation.correlation_time}}},
          {"files", files},
          {"preview", {{"start_s", preview_.start}, {"piece_s", preview_.length}}},
          {"settings", package::settings_json(setup_)}};
}

void LaserScan::print(const scan::LaserResult& recorded,
                      const std::filesystem::path& folder) const {
  const double pulses = pulse_count(recorded.scan.progress.firings), time = recorded.reached.time;
  std::ostream& out = console_.out;
  out << fmt::format(
             "{}: {}, {:.1f} s of flight{}\n  scan      {:.2f} M pulses, {:.2f} M points in {:.1f} "
             "s, {:.1f} M pulses/s\n",
             setup_.name, sensor_.name, to_seconds(recorded.scan.progress.firings),
             recorded.scan.is_complete ? "" : ", interrupted", 1e-6 * pulses,
             1e-6 * static_cast<double>(recorded.scan.progress.points), time, 1e-6 * pulses / time)
      << "  results   " << folder.string();
  for (const scan::LaserOutput& file : outputs_) {
    out << fmt::format(", {} {:.1f} MB", file.name, 1e-6 * static_cast<double>(file.bytes));
  }
  out << "\n" << std::flush;
}

}  // namespace skycap::missions::cli
