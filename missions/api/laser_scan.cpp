#include "missions/api/laser_scan.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/parallel.h"
#include "missions/api/mission_contents.h"
#include "missions/api/sensors.h"
#include "missions/config/preset_files.h"
#include "missions/scan/scan_flight.h"
#include "missions/scene/scene_source.h"

namespace skycap::missions::api {
namespace {

/// Returns the number of firings per part. Its returns fit into the processor cache; it is a
/// multiple of the noise block size.
std::uint64_t firings_in_part(std::size_t channels) {
  constexpr std::uint64_t pulses_per_part = 1 << 12, block = 32;
  return std::max<std::uint64_t>(1, pulses_per_part / (channels * block)) * block;
}

/// A piece contains about 250,000 pulses.
constexpr std::size_t parts_per_chunk = 64;

sim::LidarConfig make_scanner(const Mission::Contents& contents, const ScanRequest& request) {
  const std::string& own = contents.setup.scan.sensor;
  sim::LidarConfig scanner =
      laser_scanner(request.sensor.value_or(config::named_from(contents.folder, own)));
  scanner.seed = contents.setup.run.seed;
  return scanner;
}

}  // namespace

struct LaserScan::Impl {
  Impl(const Mission::Contents& contents, const ScanRequest& request)
      : threads(contents.setup.run.threads),
        lidar(make_scanner(contents, request)),
        scan_flight(scan::scan_flight(contents.setup.scan, contents.setup.run.seed, contents.folder,
                                      request.route, scan::Platform::airframe)),
        scene(scene::reflecting_scene(contents.setup.scene(), contents.folder).scene(threads)),
        firings(lidar.firings(scan_flight.route.platform)),
        parts(parts_per_chunk) {
    scan::require_measurable(lidar, scan_flight.route.platform);
  }

  unsigned threads;
  sim::Lidar lidar;
  scan::ScanFlight scan_flight;
  sim::Scene scene;
  std::uint64_t firings, done = 0;
  std::vector<sim::LidarReturns> parts;
};

LaserScan::LaserScan(const Mission& mission, const ScanRequest& request)
    : impl_(std::make_unique<Impl>(mission.contents(), request)) {}

LaserScan::~LaserScan() = default;

std::span<const sim::LidarReturns> LaserScan::next() {
  Impl& scan = *impl_;
  const sim::LidarFlight flight = scan.scan_flight.lidar_flight();
  const std::uint64_t step = firings_in_part(scan.lidar.config().channels.size());
  const std::uint64_t left = scan.firings - scan.done;
  const std::size_t count = std::min<std::uint64_t>(parts_per_chunk, (left + step - 1) / step);
  geometry::parallel_for(count, scan.threads, [&](std::size_t i) {
    const std::uint64_t first = scan.done + i * step;
    const sim::FiringRange range{first, std::min(step, scan.firings - first)};
    scan.parts[i] = scan.lidar.measure(scan.scene, flight, range, std::move(scan.parts[i]));
  });
  scan.done += std::min<std::uint64_t>(left, count * step);
  return std::span(scan.parts).first(count);
}

}  // namespace skycap::missions::api
