#include "missions/scan/scan_flight.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/record_log.h"
#include "geometry/place/platform.h"
#include "missions/support/number_text.h"

namespace skycap::missions::scan {
namespace {

using Eigen::Isometry3d;

ScanRoute route_of(const FlownScanOptions& options, const std::filesystem::path& folder,
                   const std::optional<std::filesystem::path>& route_file, Carrier carrier) {
  if (route_file) return read_scan_route(*route_file, options, carrier);
  if (options.route) return read_scan_route(folder / *options.route, options, carrier);
  return {orbit_trajectory(options.orbit), {}};
}

Mount calibrated_mount(const FlownScanOptions& options) {
  const Isometry3d real = options.mount();
  Isometry3d believed = geometry::rotation_of(options.boresight_error) * real;
  believed.translation() = options.mount_position + options.lever_arm_error;
  return {real, believed};
}

sim::Trajectory believed_by(sim::NavigationErrors errors, std::uint64_t seed,
                            const sim::Trajectory& flown) {
  errors.seed = seed;
  return sim::believed_trajectory(flown, errors);
}

}  // namespace

ScanFlight scan_flight(const FlownScanOptions& options, std::uint64_t seed,
                       const std::filesystem::path& folder,
                       const std::optional<std::filesystem::path>& route_file, Carrier carrier) {
  ScanRoute route = route_of(options, folder, route_file, carrier);
  sim::Trajectory believed = believed_by(options.navigation, seed, route.carrier);
  return {std::move(route), std::move(believed), calibrated_mount(options)};
}

std::string digest_of(const ScanFlight& flight) {
  std::vector<double> numbers = flight.route.image_times;
  const auto add = [&](const auto& values) {
    numbers.insert(numbers.end(), values.data(), values.data() + values.size());
  };
  for (const sim::Trajectory* trajectory : {&flight.route.carrier, &flight.believed}) {
    for (const sim::StampedPose& pose : trajectory->poses()) {
      numbers.push_back(pose.time);
      add(pose.position);
      add(pose.attitude.coeffs());
    }
  }
  for (const Isometry3d* mount : {&flight.mount.real, &flight.mount.believed}) {
    add(mount->matrix());
  }
  return fmt::format("{:08x}", geometry::crc32_of({reinterpret_cast<const char*>(numbers.data()),
                                                   numbers.size() * sizeof(double)}));
}

std::function<bool(const Eigen::AlignedBox3d&)> within_reach(const ScanFlight& flight,
                                                             const TimeSpan& span, double range) {
  // Margin for rounding and for beams that leave the sensor off its axis [m].
  constexpr double margin = 1.0;
  const double reach = range + flight.mount.real.translation().norm() + margin;
  // Boxes of the straight segments between poses of the platform.
  std::vector<Eigen::AlignedBox3d> ways;
  Eigen::Vector3d before = flight.route.carrier.pose(span.start).translation();
  const auto fly_to = [&](const Eigen::Vector3d& place) {
    ways.emplace_back(before.cwiseMin(place), before.cwiseMax(place));
    before = place;
  };
  for (const sim::StampedPose& pose : flight.route.carrier.poses()) {
    if (pose.time > span.start && pose.time < span.end) fly_to(pose.position);
  }
  fly_to(flight.route.carrier.pose(span.end).translation());
  return [ways, reach](const Eigen::AlignedBox3d& box) {
    return std::ranges::any_of(ways,
                               [&](const auto& way) { return way.exteriorDistance(box) <= reach; });
  };
}

void require_measurable(const sim::Lidar& lidar, const sim::Trajectory& flown) {
  constexpr double most_firings = 1e11;
  const double duration = flown.end() - flown.start();
  const double firings = duration / lidar.config().firing_period;
  if (firings <= most_firings) return;
  throw Error(ErrorKind::bad_config, "scan: the route takes " + support::short_text(duration) +
                                         " s, in which the sensor's " + "firing period of " +
                                         support::short_text(lidar.config().firing_period) +
                                         " s results in " + support::short_text(firings) +
                                         " firings; at most " + support::short_text(most_firings) +
                                         " can be simulated");
}

}  // namespace skycap::missions::scan
