#include "missions/evaluation/evaluation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "geometry/parallel.h"
#include "geometry/pose/space_curve.h"
#include "geometry/random_numbers.h"
#include "missions/evaluation/coverage.h"
#include "missions/evaluation/downsampled_cloud.h"

namespace skycap::missions::evaluation {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Neighbouring samples whose visibility is not yet known. Their sight lines in one direction are
/// traced together.
struct Neighbours {
  struct Sample {
    std::uint32_t index;
    Vector3d position;
  };
  std::vector<Sample> samples;
  const sim::Scene* scene;
  const Admissible* admissible;

  /// Removes samples visible from a direction. Admissibility is tested first, because it takes less
  /// time than occlusion.
  void mark_visible(const Vector3d& direction, std::vector<std::uint8_t>& is_visible) {
    std::array<sim::Scene::SightLine, sim::Scene::max_sight_lines> sight_lines;
    std::array<std::size_t, sim::Scene::max_sight_lines> targets;
    std::size_t count = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Vector3d& target = samples[i].position;
      const Vector3d from = target + admissible->view_distance * direction;
      if (admissible->allows && !admissible->allows({from, -direction})) continue;
      sight_lines[count] = {from, target + admissible->clearance * direction};
      targets[count++] = i;
    }
    if (count == 0) return;
    const std::uint32_t blocked = scene->blocked(std::span(sight_lines).first(count));
    for (std::size_t k = 0; k < count; ++k) {
      if ((blocked >> k & 1U) == 0) is_visible[samples[targets[k]].index] = 1;
    }
    std::erase_if(samples, [&](const Sample& sample) { return is_visible[sample.index] != 0; });
  }
};

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
  const std::vector<geometry::CurveEntry> order =
      geometry::along_curve(samples, geometry::finest_grid(samples));
  constexpr std::size_t group = sim::Scene::max_sight_lines;
  geometry::parallel_for((samples.size() + group - 1) / group, threads, [&](std::size_t i) {
    if (stop.stop_requested()) return;
    const std::size_t begin = i * group;
    Neighbours hidden{{}, &scene, &admissible};
    for (const auto& entry :
         std::span(order).subspan(begin, std::min(group, order.size() - begin))) {
      hidden.samples.push_back({entry.index, samples[entry.index].cast<double>()});
    }
    // Each sample group starts with another direction, which avoids a directional bias. A free
    // direction is found as fast as with any fixed order.
    for (std::size_t k = 0; k < directions.size() && !hidden.samples.empty(); ++k) {
      hidden.mark_visible(directions[(i + k) % directions.size()], is_visible);
    }
  });
  return is_visible;
}

std::vector<std::uint8_t> attainable_samples(
    std::span<const Vector3f> samples, std::span<const std::uint8_t> is_visible,
    const sim::Scene& scene, const CaptureScan& capture_scan, const Admissible& admissible,
    const AttainableConfig& config, const std::stop_token& stop) {
  const std::vector<Vector3d> directions = fibonacci_directions(admissible.directions);
  geometry::RandomNumbers random(config.seed);
  std::vector<std::uint32_t> targets;  // visible samples in random order
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    if (is_visible[i]) targets.push_back(i);
  }
  std::shuffle(targets.begin(), targets.end(), random);

  CoverageMeter meter(samples, config.registration_distance);
  DownsampledCloud cloud(config.spacing);
  geometry::Scan scan;
  std::size_t next = 0;
  for (std::size_t view = 0; view < config.views && !stop.stop_requested(); ++view) {
    while (next < targets.size() && meter.is_covered()[targets[next]]) ++next;
    if (next == targets.size()) break;
    const Vector3d target = samples[targets[next++]].cast<double>();
    const auto position =
        free_position(target, directions, random() % directions.size(), scene, admissible);
    if (!position) continue;  // does not occur, because the sample is visible
    scan = capture_scan(geometry::look_at(*position, target), view, std::move(scan));
    meter.add(cloud.store(scan.points, config.box));
  }
  return meter.is_covered();
}

}  // namespace skycap::missions::evaluation
