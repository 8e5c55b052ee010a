#include "missions/judge/evaluation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>

#include "geometry/parallel.h"
#include "missions/judge/coverage.h"
#include "missions/judge/thinned_cloud.h"

namespace skycap::missions::judge {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t samples_in_a_task = 1024;

}  // namespace

std::optional<Vector3d> free_position(const Vector3d& target, std::span<const Vector3d> directions,
                                      std::size_t first, const sim::Scene& scene,
                                      const Admissible& admissible) {
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Vector3d& direction = directions[(first + i) % directions.size()];
    const Vector3d position = target + admissible.view_distance * direction;
    if (scene.is_blocked(position, target + admissible.clearance * direction)) continue;
    if (!admissible.allows || admissible.allows({position, -direction})) return position;
  }
  return std::nullopt;
}

std::vector<std::uint8_t> visible_samples(std::span<const Vector3f> samples,
                                          const sim::Scene& scene, const Admissible& admissible,
                                          unsigned threads, std::stop_token stop) {
  const std::vector<Vector3d> directions = fibonacci_directions(admissible.directions);
  std::vector<std::uint8_t> is_visible(samples.size(), 0);
  const std::size_t tasks = (samples.size() + samples_in_a_task - 1) / samples_in_a_task;
  geometry::parallel_for(tasks, threads, [&](std::size_t task) {
    if (stop.stop_requested()) return;
    const std::size_t end = std::min(samples.size(), (task + 1) * samples_in_a_task);
    for (std::size_t i = task * samples_in_a_task; i < end; ++i) {
      // Starting at another direction each time tells nothing about where "up" is, and finds a
      // free one as soon as any fixed order would.
      const bool found =
          free_position(samples[i].cast<double>(), directions, i, scene, admissible).has_value();
      is_visible[i] = found ? 1 : 0;
    }
  });
  return is_visible;
}

std::vector<std::uint8_t> attainable_samples(std::span<const Vector3f> samples,
                                             std::span<const std::uint8_t> is_visible,
                                             const sim::Scene& scene, const TakeScan& take_scan,
                                             const Admissible& admissible,
                                             const CeilingConfig& config, std::stop_token stop) {
  const std::vector<Vector3d> directions = fibonacci_directions(admissible.directions);
  std::mt19937_64 random(config.seed);
  std::vector<std::uint32_t> targets;  // visible samples in random order
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    if (is_visible[i]) targets.push_back(i);
  }
  std::shuffle(targets.begin(), targets.end(), random);

  CoverageMeter meter(samples, config.registration_distance);
  ThinnedCloud cloud(config.spacing);
  geometry::Scan scan;
  std::size_t next = 0;
  for (std::size_t view = 0; view < config.views && !stop.stop_requested(); ++view) {
    while (next < targets.size() && meter.is_covered()[targets[next]]) ++next;
    if (next == targets.size()) break;
    const Vector3d target = samples[targets[next++]].cast<double>();
    const auto position =
        free_position(target, directions, random() % directions.size(), scene, admissible);
    if (!position) continue;  // cannot be: the sample is visible
    scan = take_scan(geometry::look_at(*position, target), view, std::move(scan));
    meter.add(cloud.store(scan.points, config.box));
  }
  return meter.is_covered();
}

}  // namespace skycap::missions::judge
