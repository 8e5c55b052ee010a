#include "missions/cli/clouds/camera_scan.h"

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "missions/cli/clouds/scan_results.h"
#include "missions/cli/write_page.h"
#include "missions/package/settings.h"
#include "missions/scan/frame_recorder.h"
#include "missions/support/json_text.h"
#include "missions/support/number_text.h"

namespace skycap::missions::cli {
namespace {

std::vector<double> image_times(const scan::ScanRoute& route, double period) {
  if (!route.image_times.empty()) return route.image_times;
  constexpr double rounding = 1e-9;
  constexpr double max_images = 1e6;
  std::vector<double> times;
  const double start = route.platform.start(), duration = route.platform.end() - start;
  if (!(duration / period <= max_images)) {
    throw Error(ErrorKind::bad_config,
                "scan.frame_period: one image every " + support::short_text(period) +
                    " s of a flight of " + support::short_text(duration) + " s results in " +
                    support::short_text(duration / period) + " images; at most " +
                    support::short_text(max_images) + " are allowed");
  }
  for (std::size_t i = 0; static_cast<double>(i) * period <= duration + rounding; ++i) {
    times.push_back(start + static_cast<double>(i) * period);
  }
  return times;
}

/// Returns an upper bound of the ray length [m]. The maximum range is measured along the optical
/// axis.
double longest_ray(const geometry::Camera& camera) {
  const Eigen::Vector2d& focal_length = camera.focal_length_px();
  return camera.config().max_range *
         (1.0 + camera.width() / focal_length.x() + camera.height() / focal_length.y());
}

}  // namespace

int scan_with_camera(const ScanCommandOptions& options, const config::MissionSetup& setup,
                     const config::SensorDescription& sensor, geometry::OutputFolder& folder,
                     const Console& console) {
  auto config = std::get<sim::DepthCameraConfig>(sensor.sensor);
  config.noise.seed = setup.run.seed;
  const scan::ScanFlight scan_flight =
      make_scan_flight(options, setup.scan, setup.run.seed, scan::Platform::gimbal);
  const auto& [route, estimated, mount] = scan_flight;
  std::vector<scan::Frame> frames;
  for (const double time : image_times(route, setup.scan.frame_period)) {
    frames.push_back({time, route.platform.pose(time) * mount.real * scan::body_from_camera(),
                      estimated.pose(time) * mount.estimated * scan::body_from_camera()});
  }
  ProgressLine progress(console, options.is_quiet);
  progress.show(setup.name + ": loading scene");
  const scene::SensedScene truth(setup.scene(), options.mission.parent_path(), setup.run.threads);
  const sim::DepthCamera camera(config);
  const sim::Scene scene = truth.scene(
      setup.run.threads, within_reach(scan_flight, {route.platform.start(), route.platform.end()},
                                      longest_ray(camera.camera())));
  const auto report = [&](std::size_t captured, std::size_t points) {
    progress.show(fmt::format("{}: image {} of {}, {:.1f} M points", setup.name, captured,
                              frames.size(), 1e-6 * static_cast<double>(points)));
  };
  const bool has_rawlog = std::ranges::find(options.formats, "rawlog") != options.formats.end();
  const PendingResultsGuard results(console);
  scan::ScanJournal journal(folder.path());
  nlohmann::ordered_json identity = make_identity(sensor, truth, scan_flight);
  identity["rawlog"] = has_rawlog;
  const nlohmann::ordered_json begun =
      open_journal(journal, options.resumes, options, setup.identity(), identity, console);
  const scan::FrameResult result = scan::record_frames(scene, camera, frames, journal, folder,
                                                       {.depth_unit = setup.scan.depth_unit,
                                                        .has_rawlog = has_rawlog,
                                                        .threads = setup.run.threads,
                                                        .begun = begun,
                                                        .report = report,
                                                        .stop = console.stop});
  const bool is_complete = result.frames == frames.size();
  folder.write(scan_name, support::json_text({{"mission", setup.name},
                                              {"sensor", sensor.name},
                                              {"seed", setup.run.seed},
                                              {"complete", is_complete},
                                              {"images", result.frames},
                                              {"images_planned", frames.size()},
                                              {"points", result.points},
                                              {"simulation_s", result.time},
                                              {"settings", package::settings_json(setup)}}));
  write_page(scan_name, options.has_report, folder, console);
  commit_scan(folder, is_complete);
  if (is_complete) journal.close();
  progress.clear();
  if (!options.is_quiet) {
    console.out << fmt::format(
                       "{}: {}{}\n  scan      {} depth images, {:.2f} M points in {:.1f} s\n",
                       setup.name, sensor.name, is_complete ? "" : ", interrupted", result.frames,
                       1e-6 * static_cast<double>(result.points), result.time)
                << "  results   " << folder.path().string() << "\n"
                << std::flush;
  }
  return is_complete ? 0 : 1;
}

}  // namespace skycap::missions::cli
