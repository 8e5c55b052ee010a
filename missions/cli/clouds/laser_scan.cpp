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

std::shared_ptr<const flight::UtmProjection> projection_of(const scan::FlownScanOptions& scan) {
  if (scan.crs == scan::ScanCrs::local) return nullptr;
  if (!scan.site) {
    throw Error(ErrorKind::bad_config,
                "scan.crs: utm requires a georeference; set site.latitude_deg and "
                "site.longitude_deg, or use local");
  }
  return std::make_shared<const flight::UtmProjection>(*scan.site);
}

/// Returns the sensor's poses as a TUM file, up to the first pose at or after `end` [s].
std::string sensor_tum(const sim::Trajectory& carrier, const Isometry3d& body_from_sensor,
                       double end) {
  std::vector<flight::TimedPose> poses;
  for (const sim::StampedPose& pose : carrier.poses()) {
    poses.push_back({pose.time, carrier.pose(pose.time) * body_from_sensor});
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
  ScanReport(ProgressLine& line, std::string name, double shots_in_firing,
             const sim::FiringRange& range)
      : line_(line), name_(std::move(name)), shots_in_firing_(shots_in_firing), range_(range) {}

  void operator()(const scan::ScanProgress& progress) {
    const Clock::time_point now = Clock::now();
    if (now - shown_ < std::chrono::milliseconds(100)) return;
    shown_ = now;
    const auto flown = static_cast<double>(progress.firings - range_.first);
    const auto all = static_cast<double>(range_.count);
    std::string text = fmt::format("{}: {:.1f}% flown, {:.1f} M points", name_, 100.0 * flown / all,
                                   1e-6 * static_cast<double>(progress.points));
    if (begun_) {
      const double rate = (flown - *begun_) / seconds_since(start_);
      text += fmt::format(", {:.1f} M pulses/s, {:.0f} s left", 1e-6 * shots_in_firing_ * rate,
                          (all - flown) / rate);
    } else {  // the pace is not yet known
      begun_ = flown;
      start_ = now;
    }
    line_.show(text);
  }

 private:
  ProgressLine& line_;
  std::string name_;
  double shots_in_firing_;
  sim::FiringRange range_;       ///< firings of the scan
  std::optional<double> begun_;  ///< completed firings at the first report
  Clock::time_point start_, shown_;
};

std::vector<scan::LaserOutput> output_files(const ScanVerbOptions& options,
                                            const scan::CloudFormatContext& context) {
  std::vector<scan::LaserOutput> outputs;
  const auto add = [&](const std::string& name, const auto& format, scan::ReturnPosition position) {
    for (const scan::LaserOutput& output : outputs) {
      if (output.name == name) {
        throw Error(ErrorKind::bad_usage, "--format conflicts: two formats have the file name " +
                                              name + "; remove one of them");
      }
    }
    outputs.push_back({name, format, position});
  };
  for (const std::string& name : options.formats) {
    const scan::CloudFormatInfo& info = scan::cloud_format_named(name);
    const std::shared_ptr<const scan::CloudFormat> format = info.make(context);
    add("scan" + info.ending, format, scan::ReturnPosition::reported);
    if (options.with_truth) add("scan_true" + info.ending, format, scan::ReturnPosition::actual);
  }
  return outputs;
}

}  // namespace

LaserScan::LaserScan(const ScanVerbOptions& options, const config::MissionSetup& setup,
                     const config::SensorDescription& sensor, const Console& console,
                     const std::filesystem::path& index)
    : options_(options),
      setup_(setup),
      sensor_(sensor),
      console_(console),
      lidar_(seeded(std::get<sim::LidarConfig>(sensor.sensor), setup.run.seed)),
      flown_(flown_by(options, setup.scan, setup.run.seed, scan::Carrier::airframe)),
      flight_(flown_.of_scanner()),
      projection_(projection_of(setup.scan)),
      preview_(scan::preview_pieces(lidar_.config(), flown_.route.carrier)),
      progress_(console, options.is_quiet),
      truth_(read_scene(index)) {
  outputs_ =
      output_files(options, {sensor.name, lidar_.config(), flight_, truth_.centre(), projection_});
  identity_ = identity_of(sensor, truth_, flown_);
  identity_.update({{"formats", options.formats}, {"truth", options.with_truth}});
  const double shots = shots_of(lidar_.firings(flown_.route.carrier));
  outputs_.push_back(
      {scan::preview_name, scan::preview_format(preview_, scan::preview_share(shots))});
}

double LaserScan::shots_of(std::uint64_t firings) const {
  return static_cast<double>(lidar_.config().channels.size()) * static_cast<double>(firings);
}

double LaserScan::seconds_of(std::uint64_t firings) const {
  return static_cast<double>(firings) * lidar_.config().firing_period;
}

Json LaserScan::identity(const scan::FlightPiece& piece) const {
  Json all = identity_;
  all.update({{"piece", piece.number}, {"pieces", piece.count}});
  return all;
}

scene::SensedScene LaserScan::read_scene(const std::filesystem::path& index) {
  scan::require_measurable(lidar_, flown_.route.carrier);
  progress_.show(setup_.name + ": loading scene");
  return {setup_.scene(), options_.mission.parent_path(), setup_.run.threads, index};
}

void LaserScan::prepare(const scan::FlightPiece& piece) {
  if (scene_ && !truth_.is_tiled()) return;
  scene_.reset();  // frees memory before loading the next scene
  const sim::FiringRange range = firings_of(piece, lidar_, flown_.route.carrier);
  const double start = flown_.route.carrier.start();
  const scan::TimeSpan span{start + seconds_of(range.first),
                            start + seconds_of(range.first + range.count)};
  scene_ =
      truth_.scene(setup_.run.threads, scan::within_reach(flown_, span, lidar_.config().max_range));
}

scan::LaserResult LaserScan::record(const scan::FlightPiece& piece, scan::ScanJournal& journal,
                                    const Json& begun, geometry::OutputFolder& folder) {
  const sim::FiringRange range = firings_of(piece, lidar_, flown_.route.carrier);
  return record_laser(*scene_, lidar_, flight_, outputs_, journal, begun, folder,
                      {.threads = setup_.run.threads,
                       .piece = piece,
                       .report = ScanReport(progress_, setup_.name, shots_of(1), range),
                       .stop = console_.stop});
}

int LaserScan::run(geometry::OutputFolder& folder) {
  prepare({});
  const HoldsResults results(console_);
  scan::ScanJournal journal(folder.path());
  const Json begun =
      open_journal(journal, options_.resumes, options_, setup_.identity(), identity_, console_);
  const scan::LaserResult recorded = record({}, journal, begun, folder);
  const int exit_code = finish(recorded, folder);
  if (recorded.scan.is_complete) journal.close();
  return exit_code;
}

bool LaserScan::run_piece(const scan::FlightPiece& piece, const std::filesystem::path& results) {
  geometry::OutputFolder folder(folder_of_piece(results, piece.number, piece.count));
  if (complete(piece, results)) return true;
  prepare(piece);
  const HoldsResults holds(console_);
  scan::ScanJournal journal(folder.path());
  const bool resumes = journal.is_of(setup_.identity(), identity(piece));
  const Json begun =
      open_journal(journal, resumes, options_, setup_.identity(), identity(piece), console_);
  const scan::LaserResult recorded = record(piece, journal, begun, folder);
  progress_.clear();
  if (!recorded.scan.is_complete) return false;
  folder.replace([](std::string_view name) {
    return !name.starts_with(".") && name != scan::ScanJournal::folder_name;
  });
  folder.write(scan::piece_name,
               scan::piece_text(support::identity_text(setup_.identity(), identity(piece)),
                                recorded.reached));
  folder.commit();
  journal.close();
  return true;
}

std::optional<scan::CompletePiece> LaserScan::complete(const scan::FlightPiece& piece,
                                                       const std::filesystem::path& results) const {
  const std::filesystem::path folder = folder_of_piece(results, piece.number, piece.count);
  auto holds = scan::complete_piece(
      folder, support::identity_text(setup_.identity(), identity(piece)), outputs_.size());
  if (!holds) return std::nullopt;
  return scan::CompletePiece{folder, std::move(*holds)};
}

int LaserScan::join(std::span<const scan::CompletePiece> pieces, geometry::OutputFolder& folder) {
  const HoldsResults results(console_);
  progress_.show(setup_.name + ": merging the pieces");
  return finish(join_pieces(pieces, outputs_, folder), folder);
}

int LaserScan::finish(const scan::LaserResult& recorded, geometry::OutputFolder& folder) {
  std::erase_if(outputs_, [](const auto& output) { return output.bytes == 0; });
  const bool is_complete = recorded.scan.is_complete;
  const sim::Trajectory& carrier = flown_.route.carrier;
  const double end =
      is_complete ? carrier.end() : carrier.start() + seconds_of(recorded.scan.progress.firings);
  folder.write("trajectory.tum", sensor_tum(carrier, flown_.mount.real, end));
  folder.write("trajectory_estimated.tum", sensor_tum(flown_.believed, flown_.mount.believed, end));
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
          {"flight_s", seconds_of(recorded.scan.progress.firings)},
          {"shots", static_cast<std::uint64_t>(shots_of(recorded.scan.progress.firings))},
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
  const double shots = shots_of(recorded.scan.progress.firings), time = recorded.reached.time;
  std::ostream& out = console_.out;
  out << fmt::format(
             "{}: {}, {:.1f} s of flight{}\n  scan      {:.2f} M pulses, {:.2f} M points in {:.1f} "
             "s, {:.1f} M pulses/s\n",
             setup_.name, sensor_.name, seconds_of(recorded.scan.progress.firings),
             recorded.scan.is_complete ? "" : ", interrupted", 1e-6 * shots,
             1e-6 * static_cast<double>(recorded.scan.progress.points), time, 1e-6 * shots / time)
      << "  results   " << folder.string();
  for (const scan::LaserOutput& file : outputs_) {
    out << fmt::format(", {} {:.1f} MB", file.name, 1e-6 * static_cast<double>(file.bytes));
  }
  out << "\n" << std::flush;
}

}  // namespace skycap::missions::cli
