#include "missions/scan/scan_flight.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/record_log.h"
#include "geometry/pose/platform.h"
#include "missions/support/number_text.h"

namespace skycap::missions::scan {
namespace {

using Eigen::Isometry3d;

ScanRoute make_route(const ScanFlightOptions& options, const std::filesystem::path& folder,
                     const std::optional<std::filesystem::path>& route_file, Platform platform) {
  if (route_file) return read_scan_route(*route_file, options, platform);
  if (options.route) return read_scan_route(folder / *options.route, options, platform);
  return {orbit_trajectory(options.orbit), {}};
}

Mount calibrated_mount(const ScanFlightOptions& options) {
  const Isometry3d real = options.mount();
  Isometry3d estimated = geometry::make_rotation(options.boresight_error) * real;
  estimated.translation() = options.mount_position + options.lever_arm_error;
  return {real, estimated};
}

sim::Trajectory estimate_trajectory(sim::NavigationErrors errors, std::uint64_t seed,
                                    const sim::Trajectory& ground_truth) {
  errors.seed = seed;
  return sim::estimated_trajectory(ground_truth, errors);
}

}  // namespace

ScanFlight scan_flight(const ScanFlightOptions& options, std::uint64_t seed,
                       const std::filesystem::path& folder,
                       const std::optional<std::filesystem::path>& route_file, Platform platform) {
  ScanRoute route = make_route(options, folder, route_file, platform);
  sim::Trajectory estimated = estimate_trajectory(options.navigation, seed, route.platform);
  return {std::move(route), std::move(estimated), calibrated_mount(options)};
}

std::string compute_checksum(const ScanFlight& flight) {
  std::vector<double> numbers = flight.route.image_times;
  const auto add = [&](const auto& values) {
    numbers.insert(numbers.end(), values.data(), values.data() + values.size());
  };
  for (const sim::Trajectory* trajectory : {&flight.route.platform, &flight.estimated}) {
    for (const sim::StampedPose& pose : trajectory->poses()) {
      numbers.push_back(pose.time);
      add(pose.position);
      add(pose.attitude.coeffs());
    }
  }
  for (const Isometry3d* mount : {&flight.mount.real, &flight.mount.estimated}) {
    add(mount->matrix());
  }
  return fmt::format("{:08x}",
                     geometry::compute_crc32({reinterpret_cast<const char*>(numbers.data()),
                                              numbers.size() * sizeof(double)}));
}

std::function<bool(const Eigen::AlignedBox3d&)> within_reach(const ScanFlight& flight,
                                                             const TimeSpan& span, double range) {
  // Margin for rounding and for beams that leave the sensor off its axis [m].
  constexpr double margin = 1.0;
  const double reach = range + flight.mount.real.translation().norm() + margin;
  // Boxes of the straight segments between poses of the platform.
  std::vector<Eigen::AlignedBox3d> leg_boxes;
  Eigen::Vector3d before = flight.route.platform.pose(span.start).translation();
  const auto fly_to = [&](const Eigen::Vector3d& position) {
    leg_boxes.emplace_back(before.cwiseMin(position), before.cwiseMax(position));
    before = position;
  };
  for (const sim::StampedPose& pose : flight.route.platform.poses()) {
    if (pose.time > span.start && pose.time < span.end) fly_to(pose.position);
  }
  fly_to(flight.route.platform.pose(span.end).translation());
  return [leg_boxes, reach](const Eigen::AlignedBox3d& box) {
    return std::ranges::any_of(
        leg_boxes, [&](const auto& path) { return path.exteriorDistance(box) <= reach; });
  };
}

void require_measurable(const sim::Lidar& lidar, const sim::Trajectory& ground_truth) {
  constexpr double max_firings = 1e11;
  const double duration = ground_truth.end() - ground_truth.start();
  const double firings = duration / lidar.config().firing_period;
  if (firings <= max_firings) return;
  throw Error(ErrorKind::bad_config,
              "scan: the route takes " + support::short_text(duration) + " s; the sensor's " +
                  "firing period of " + support::short_text(lidar.config().firing_period) +
                  " s results in " + support::short_text(firings) + " firings; at most " +
                  support::short_text(max_firings) + " can be simulated");
}

}  // namespace skycap::missions::scan
