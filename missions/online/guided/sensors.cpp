#include "missions/online/guided/sensors.h"

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/config/survey_sensor.h"
#include "missions/evaluation/survey_scene.h"

namespace skycap::missions::online {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::array endings{".ply", ".pcd", ".las", ".laz", ".e57", ".xyz", ".png"};

std::optional<fs::path> scan_in(const fs::path& folder, const std::string& name) {
  for (const char* ending : endings) {
    const fs::path file = folder / (name + ending);
    std::error_code failure;
    if (fs::exists(file, failure)) return file;
  }
  return std::nullopt;
}

std::string pose_text(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  const Eigen::Vector3d place = pose.translation();
  return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", place.x(),
                     place.y(), place.z(), turn.x(), turn.y(), turn.z(), turn.w());
}

fs::path wait_for_scan(const fs::path& folder, const std::string& name, double patience,
                       const std::stop_token& stop) {
  const auto end = Clock::now() + std::chrono::duration<double>(patience);
  while (Clock::now() < end && !stop.stop_requested()) {
    if (const auto file = scan_in(folder, name)) return *file;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  throw Error(ErrorKind::bad_file, (folder / name).string() + ".*: no scan came");
}

}  // namespace

Sensor folder_sensor(const config::Mission& mission, const fs::path& folder,
                     online::ScanInput input, double patience, std::stop_token stop) {
  if (!fs::is_directory(folder)) {
    throw Error(ErrorKind::bad_file, folder.string() + ": is no folder; name one for scans");
  }
  return [mission, folder, input = std::move(input), patience, stop = std::move(stop)](
             const geometry::View&, const geometry::View& taken, std::size_t number) {
    const std::string name = fmt::format("scan-{:04}", number);
    if (const auto old = scan_in(folder, name)) {
      throw Error(ErrorKind::bad_file, old->string() + ": is there before the scan was taken");
    }
    online::ScanInput wanted = input;
    wanted.world_from_sensor = geometry::camera_pose(taken);
    geometry::write_file(folder / (name + ".pose"), pose_text(wanted.world_from_sensor));
    wanted.file = wait_for_scan(folder, name, patience, stop);
    online::ScanFound found = online::read_scan(wanted, mission);
    online::require_usable(found.scan, mission);
    return std::move(found.scan);
  };
}

Sensor simulated_sensor(const config::Mission& mission,
                        const std::filesystem::path& mission_folder) {
  if (mission.scene.model.empty()) {
    throw Error(ErrorKind::bad_config,
                "scene.model is missing; a simulated sensor needs a scene to measure");
  }
  const auto scene = std::make_shared<evaluation::SurveyScene>(mission, mission_folder);
  const auto sensor = std::make_shared<config::SurveySensor>(mission.sensor, mission.seed);
  return [scene, sensor, threads = mission.threads](
             const geometry::View&, const geometry::View& taken, std::size_t number) {
    return sensor->scan(scene->scene(), taken, number, threads);
  };
}

}  // namespace skycap::missions::online
