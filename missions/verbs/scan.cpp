#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/export/trajectory_file.h"
#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "geometry/io/record_log.h"
#include "missions/derived/mission_flight.h"
#include "missions/derived/resolved_mission.h"
#include "missions/equipment/preset_files.h"
#include "missions/equipment/sensor_reader.h"
#include "missions/file/json_text.h"
#include "missions/file/number_text.h"
#include "missions/package/package.h"
#include "missions/package/settings.h"
#include "missions/recording/cloud_formats.h"
#include "missions/recording/frame_recorder.h"
#include "missions/recording/laser_recorder.h"
#include "missions/recording/preview.h"
#include "missions/recording/scan_flight.h"
#include "missions/recording/scan_journal.h"
#include "missions/recording/scan_runner.h"
#include "missions/scene/scene_source.h"
#include "missions/verbs/verbs.h"
#include "missions/verbs/write_page.h"

namespace skycap::missions::verbs {
namespace {

using Eigen::Isometry3d;
using Clock = std::chrono::steady_clock;

constexpr const char* scan_name = "scan.json";

equipment::SensorDescription sensor_of(const ScanVerbOptions& options,
                                       const file::Mission& mission) {
  return equipment::find_sensor(options.sensor.value_or(
      equipment::named_from(options.mission.parent_path(), mission.scan.sensor)));
}

recording::ScanFlight flown_by(const ScanVerbOptions& options, const file::Mission& mission,
                               recording::Carrier carrier) {
  return recording::scan_flight(mission, options.mission.parent_path(), options.route, carrier);
}

std::shared_ptr<const flight::UtmProjection> projection_of(const file::Mission& mission) {
  if (mission.scan.crs == file::ScanCrs::local) return nullptr;
  if (!derived::has_place(mission)) {
    throw Error(ErrorKind::bad_config,
                "scan.crs is utm, but the mission has no place; add site.latitude_deg and "
                "site.longitude_deg, or say local");
  }
  return std::make_shared<const flight::UtmProjection>(derived::site_of(mission));
}

/// The sensor's poses, up to the first that is not before `end`, as a TUM file.
std::string sensor_tum(const sim::Trajectory& carrier, const Isometry3d& body_from_sensor,
                       double end) {
  std::vector<flight::TimedPose> poses;
  for (const sim::StampedPose& pose : carrier.poses()) {
    poses.push_back({pose.time, carrier.pose(pose.time) * body_from_sensor});
    if (pose.time >= end) break;
  }
  return flight::write_tum(poses);
}

/// Commits a scan; one that was interrupted goes beside a complete one instead of over it, and
/// keeps its journal.
void commit_scan(geometry::OutputFolder& folder, recording::ScanJournal& journal,
                 bool is_complete) {
  if (!is_complete && package::is_complete_result(folder.path() / scan_name)) {
    folder.move_to("interrupted");
  }
  folder.commit();
  if (is_complete) journal.close();
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Shows how far a scan is, ten times a second at most.
class ScanReport {
 public:
  ScanReport(ProgressLine& line, std::string name, double shots_in_firing)
      : line_(line), name_(std::move(name)), shots_in_firing_(shots_in_firing) {}

  void operator()(const recording::ScanProgress& progress) {
    const Clock::time_point now = Clock::now();
    if (now - shown_ < std::chrono::milliseconds(100)) return;
    shown_ = now;
    const auto flown = static_cast<double>(progress.firings);
    const auto all = static_cast<double>(progress.all_firings);
    std::string text =
        fmt::format("{}: {:.1f} % flown, {:.1f} M points", name_, 100.0 * flown / all,
                    1e-6 * static_cast<double>(progress.points));
    if (begun_) {
      const double rate = (flown - static_cast<double>(*begun_)) / seconds_since(start_);
      text += fmt::format(", {:.1f} M shots/s, {:.0f} s left", 1e-6 * shots_in_firing_ * rate,
                          (all - flown) / rate);
    } else {  // the pace is not known yet
      begun_ = progress.firings;
      start_ = now;
    }
    line_.show(text);
  }

 private:
  ProgressLine& line_;
  std::string name_;
  double shots_in_firing_;
  std::optional<std::uint64_t> begun_;  ///< firings when the first report came
  Clock::time_point start_, shown_;
};

std::vector<recording::LaserOutput> output_files(const ScanVerbOptions& options,
                                                 const recording::CloudFormatContext& context) {
  std::vector<recording::LaserOutput> outputs;
  const auto add = [&](const std::string& name, const auto& format,
                       recording::ReturnPosition position) {
    for (const recording::LaserOutput& output : outputs) {
      if (output.name == name) {
        throw Error(ErrorKind::bad_usage,
                    "--format asks for two files " + name + "; leave one of the formats out");
      }
    }
    outputs.push_back({name, format, position});
  };
  for (const std::string& name : options.formats) {
    const recording::CloudFormatInfo& info = recording::cloud_format_named(name);
    const std::shared_ptr<const recording::CloudFormat> format = info.make(context);
    add("scan" + info.ending, format, recording::ReturnPosition::reported);
    if (options.with_truth)
      add("scan_true" + info.ending, format, recording::ReturnPosition::actual);
  }
  return outputs;
}

/// What a laser scanner has recorded.
struct LaserRecording {
  std::string sensor;
  recording::ScanResult result;
  double shots = 0.0;
  double flown = 0.0;  ///< [s]
  double time = 0.0;   ///< that the simulation took [s]
  std::vector<recording::LaserOutput> outputs;
};

nlohmann::ordered_json scan_json(const file::Mission& mission, const LaserRecording& recorded,
                                 const recording::PreviewPieces& pieces) {
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const recording::LaserOutput& file : recorded.outputs) {
    files.push_back({{"name", file.name}, {"bytes", file.bytes}});
  }
  const sim::NavigationErrors& navigation = mission.scan.navigation;
  return {{"mission", mission.name},
          {"sensor", recorded.sensor},
          {"seed", mission.seed},
          {"complete", recorded.result.is_complete},
          {"flight_s", recorded.flown},
          {"shots", static_cast<std::uint64_t>(recorded.shots)},
          {"points", recorded.result.progress.points},
          {"las_crs", mission.scan.crs == file::ScanCrs::utm ? "utm" : "local"},
          {"simulation_s", recorded.time},
          {"navigation",
           {{"horizontal_sigma_m", navigation.horizontal_sigma},
            {"vertical_sigma_m", navigation.vertical_sigma},
            {"tilt_sigma_rad", navigation.tilt_sigma},
            {"heading_sigma_rad", navigation.heading_sigma},
            {"correlation_time_s", navigation.correlation_time}}},
          {"files", files},
          {"preview", {{"start_s", pieces.start}, {"piece_s", pieces.length}}},
          {"settings", package::settings_json(mission)}};
}

void print(const LaserRecording& recorded, const file::Mission& mission,
           const std::filesystem::path& folder, std::ostream& out) {
  out << fmt::format(
             "{}: {}, {:.1f} s of flight{}\n"
             "  scan      {:.2f} M shots, {:.2f} M points in {:.1f} s, {:.1f} M shots/s\n",
             mission.name, recorded.sensor, recorded.flown,
             recorded.result.is_complete ? "" : ", interrupted", 1e-6 * recorded.shots,
             1e-6 * static_cast<double>(recorded.result.progress.points), recorded.time,
             1e-6 * recorded.shots / recorded.time)
      << "  results   " << folder.string();
  for (const recording::LaserOutput& file : recorded.outputs) {
    out << fmt::format(", {} {:.1f} MB", file.name, 1e-6 * static_cast<double>(file.bytes));
  }
  out << "\n" << std::flush;
}

/// What a scan is made of: the sensor's description, the scene, the flight.
nlohmann::ordered_json identity_of(const equipment::SensorDescription& sensor,
                                   const scene::ReflectingScene& scene,
                                   const recording::ScanFlight& flight) {
  return {{"sensor", sensor.name},
          {"sensor_digest", fmt::format("{:08x}", geometry::crc32_of(sensor.text))},
          {"scene_digest", scene.digest()},
          {"route_digest", digest_of(flight)}};
}

/// Begins a scan, or goes on with an interrupted one from what is returned.
nlohmann::ordered_json open_journal(recording::ScanJournal& journal, const ScanVerbOptions& options,
                                    const file::Mission& mission,
                                    const nlohmann::ordered_json& identity,
                                    const Console& console) {
  nlohmann::ordered_json begun = journal.open(mission, identity, options.resumes);
  if (begun.is_object() && !options.is_quiet) {
    console.err << "going on with an interrupted scan\n" << std::flush;
  }
  return begun;
}

int scan_with_laser(const ScanVerbOptions& options, const file::Mission& mission,
                    const equipment::SensorDescription& sensor, geometry::OutputFolder& folder,
                    const Console& console) {
  auto config = std::get<sim::LidarConfig>(sensor.sensor);
  config.seed = mission.seed;
  const sim::Lidar lidar(config);
  const recording::ScanFlight flown = flown_by(options, mission, recording::Carrier::airframe);
  recording::require_measurable(lidar, flown.route.carrier);
  const sim::LidarFlight flight = flown.of_scanner();
  const std::shared_ptr<const flight::UtmProjection> projection = projection_of(mission);
  recording::ScanJournal journal(folder.path());

  ProgressLine progress(console, options.is_quiet);
  progress.show(mission.name + ": making the scene ready");
  const scene::ReflectingScene truth =
      scene::reflecting_scene(mission, options.mission.parent_path());
  const sim::Scene scene = truth.scene(mission.threads);
  LaserRecording recorded{.sensor = sensor.name};
  recorded.outputs =
      output_files(options, {sensor.name, config, flight, truth.centre(), projection});

  const auto channels = static_cast<double>(config.channels.size());
  const recording::PreviewPieces pieces = recording::preview_pieces(config, flown.route.carrier);
  const auto all_firings = static_cast<double>(lidar.firings(flown.route.carrier));
  recorded.outputs.push_back(
      {recording::preview_name,
       recording::preview_format(pieces, recording::preview_share(channels * all_firings))});
  const HoldsResults results(console);
  nlohmann::ordered_json identity = identity_of(sensor, truth, flown);
  identity.update({{"formats", options.formats}, {"truth", options.with_truth}});
  const nlohmann::ordered_json begun = open_journal(journal, options, mission, identity, console);
  const auto [result, time] =
      record_laser(scene, lidar, flight, recorded.outputs, journal, begun, folder,
                   {.threads = mission.threads,
                    .report = ScanReport(progress, mission.name, channels),
                    .stop = console.stop});
  recorded.result = result;
  recorded.time = time;
  std::erase_if(recorded.outputs, [](const auto& output) { return output.bytes == 0; });
  const auto firings = static_cast<double>(recorded.result.progress.firings);
  recorded.shots = channels * firings, recorded.flown = firings * config.firing_period;
  const double end = recorded.result.is_complete ? flown.route.carrier.end()
                                                 : flown.route.carrier.start() + recorded.flown;
  folder.write("trajectory.tum", sensor_tum(flown.route.carrier, flown.mount.real, end));
  folder.write("trajectory_believed.tum", sensor_tum(flown.believed, flown.mount.believed, end));
  folder.write(scan_name, file::json_text(scan_json(mission, recorded, pieces)));
  write_page(scan_name, options.has_report, folder, console);
  commit_scan(folder, journal, recorded.result.is_complete);
  progress.clear();
  if (!options.is_quiet) print(recorded, mission, folder.path(), console.out);
  return recorded.result.is_complete ? 0 : 1;
}

std::vector<double> image_times(const recording::ScanRoute& route, double period) {
  if (!route.image_times.empty()) return route.image_times;
  constexpr double rounding = 1e-9;
  constexpr double most_images = 1e6;
  std::vector<double> times;
  const double start = route.carrier.start(), duration = route.carrier.end() - start;
  if (!(duration / period <= most_images)) {
    throw Error(ErrorKind::bad_config, "scan.frame_period: every " + file::short_text(period) +
                                           " s of a flight of " + file::short_text(duration) +
                                           " s would be " + file::short_text(duration / period) +
                                           " images; at most " + file::short_text(most_images) +
                                           " are taken");
  }
  for (std::size_t i = 0; static_cast<double>(i) * period <= duration + rounding; ++i) {
    times.push_back(start + static_cast<double>(i) * period);
  }
  return times;
}

int scan_with_camera(const ScanVerbOptions& options, const file::Mission& mission,
                     const equipment::SensorDescription& sensor, geometry::OutputFolder& folder,
                     const Console& console) {
  auto config = std::get<sim::DepthCameraConfig>(sensor.sensor);
  config.noise.seed = mission.seed;
  const recording::ScanFlight flown = flown_by(options, mission, recording::Carrier::gimbal);
  const auto& [route, believed, mount] = flown;
  std::vector<recording::Frame> frames;
  for (const double time : image_times(route, mission.scan.frame_period)) {
    frames.push_back({time, route.carrier.pose(time) * mount.real * recording::body_from_camera(),
                      believed.pose(time) * mount.believed * recording::body_from_camera()});
  }
  ProgressLine progress(console, options.is_quiet);
  progress.show(mission.name + ": making the scene ready");
  const scene::ReflectingScene truth =
      scene::reflecting_scene(mission, options.mission.parent_path());
  const sim::Scene scene = truth.scene(mission.threads);
  const auto report = [&](std::size_t taken, std::size_t points) {
    progress.show(fmt::format("{}: image {} of {}, {:.1f} M points", mission.name, taken,
                              frames.size(), 1e-6 * static_cast<double>(points)));
  };
  const bool has_rawlog = std::ranges::find(options.formats, "rawlog") != options.formats.end();
  const HoldsResults results(console);
  const sim::DepthCamera camera(config);
  recording::ScanJournal journal(folder.path());
  nlohmann::ordered_json identity = identity_of(sensor, truth, flown);
  identity["rawlog"] = has_rawlog;
  const nlohmann::ordered_json begun = open_journal(journal, options, mission, identity, console);
  const recording::FrameResult result =
      recording::record_frames(scene, camera, frames, journal, folder,
                               {.depth_unit = mission.scan.depth_unit,
                                .has_rawlog = has_rawlog,
                                .threads = mission.threads,
                                .begun = begun,
                                .report = report,
                                .stop = console.stop});
  const bool is_complete = result.frames == frames.size();
  folder.write(scan_name, file::json_text({{"mission", mission.name},
                                           {"sensor", sensor.name},
                                           {"seed", mission.seed},
                                           {"complete", is_complete},
                                           {"images", result.frames},
                                           {"images_planned", frames.size()},
                                           {"points", result.points},
                                           {"simulation_s", result.time},
                                           {"settings", package::settings_json(mission)}}));
  write_page(scan_name, options.has_report, folder, console);
  commit_scan(folder, journal, is_complete);
  progress.clear();
  if (!options.is_quiet) {
    console.out << fmt::format(
                       "{}: {}{}\n  scan      {} depth images, {:.2f} M points in {:.1f} s\n",
                       mission.name, sensor.name, is_complete ? "" : ", interrupted", result.frames,
                       1e-6 * static_cast<double>(result.points), result.time)
                << "  results   " << folder.path().string() << "\n"
                << std::flush;
  }
  return is_complete ? 0 : 1;
}

}  // namespace

int scan(const ScanVerbOptions& options, const Console& console) {
  const file::Mission mission = read_shown(derived::read_mission, options, console);
  const equipment::SensorDescription sensor = sensor_of(options, mission);
  geometry::OutputFolder folder(
      options.out.value_or(std::filesystem::path("results") / mission.name / "scan"));
  const bool is_laser = std::holds_alternative<sim::LidarConfig>(sensor.sensor);
  const auto scan_it = is_laser ? scan_with_laser : scan_with_camera;
  return scan_it(options, mission, sensor, folder, console);
}

}  // namespace skycap::missions::verbs
