#include <algorithm>
#include <filesystem>
#include <variant>

#include "geometry/error.h"
#include "missions/cli/clouds/camera_scan.h"
#include "missions/cli/clouds/laser_scan.h"
#include "missions/cli/clouds/split_scan.h"
#include "missions/cli/verbs.h"
#include "missions/config/preset_files.h"
#include "missions/config/resolve.h"

namespace skycap::missions::cli {
namespace {

config::SensorDescription sensor_of(const ScanVerbOptions& options,
                                    const scan::FlownScanOptions& scan) {
  return config::find_sensor(
      options.sensor.value_or(config::named_from(options.mission.parent_path(), scan.sensor)));
}

}  // namespace

int scan(const ScanVerbOptions& options, const Console& console) {
  const config::MissionSetup setup = read_shown(config::read_mission, options, console);
  const config::SensorDescription sensor = sensor_of(options, setup.scan);
  const std::filesystem::path out =
      options.out.value_or(std::filesystem::path("results") / setup.name / "scan");
  const bool is_laser = std::holds_alternative<sim::LidarConfig>(sensor.sensor);
  if (options.pieces > 0) {
    if (!is_laser) {
      throw Error(
          ErrorKind::bad_usage,
          "--pieces: " + sensor.name + " is a camera; only scans of laser scanners can be split");
    }
    return split_scan(options, setup, sensor, out, console);
  }
  if (options.task.is_given()) {
    throw Error(ErrorKind::bad_usage, "--index, --chunk, --collect and --submit require --pieces");
  }
  geometry::OutputFolder folder(out);
  if (!is_laser) return scan_with_camera(options, setup, sensor, folder, console);
  return LaserScan(options, setup, sensor, console).run(folder);
}

}  // namespace skycap::missions::cli
