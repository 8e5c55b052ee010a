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

namespace skycap::missions::online {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::array extensions{".ply", ".pcd", ".las", ".laz", ".e57", ".xyz", ".png"};

std::optional<fs::path> scan_in(const fs::path& folder, const std::string& name) {
  for (const char* extension : extensions) {
    const fs::path file = folder / (name + extension);
    std::error_code failure;
    if (fs::exists(file, failure)) return file;
  }
  return std::nullopt;
}

std::string pose_text(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  const Eigen::Vector3d position = pose.translation();
  return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", position.x(),
                     position.y(), position.z(), turn.x(), turn.y(), turn.z(), turn.w());
}

fs::path wait_for_scan(const fs::path& folder, const std::string& name, double patience,
                       const std::stop_token& stop) {
  const auto end = Clock::now() + std::chrono::duration<double>(patience);
  while (Clock::now() < end && !stop.stop_requested()) {
    if (const auto file = scan_in(folder, name)) return *file;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  throw Error(ErrorKind::bad_file, (folder / name).string() + ".*: timeout: no scan arrived");
}

}  // namespace

Sensor folder_sensor(const flight::FlightOptions& flight, const LiveOptions& live,
                     const fs::path& folder, ScanInput input, double patience,
                     std::stop_token stop) {
  if (!fs::is_directory(folder)) {
    throw Error(
        ErrorKind::bad_file,
        folder.string() + ": is not a folder; specify the folder to which scans are written");
  }
  return [flight, live, folder, input = std::move(input), patience, stop = std::move(stop)](
             const geometry::View&, const geometry::View& actual_view, std::size_t number) {
    const std::string name = fmt::format("scan-{:04}", number);
    if (const auto old = scan_in(folder, name)) {
      throw Error(ErrorKind::bad_file,
                  old->string() + ": already existed before the scan was taken; empty the folder");
    }
    ScanInput requested = input;
    requested.world_from_sensor = geometry::camera_pose(actual_view);
    geometry::write_file(folder / (name + ".pose"), pose_text(requested.world_from_sensor));
    requested.file = wait_for_scan(folder, name, patience, stop);
    ScanFound found = read_scan(requested, flight.capture, live);
    require_usable(found.scan, flight);
    return std::move(found.scan);
  };
}

}  // namespace skycap::missions::online
