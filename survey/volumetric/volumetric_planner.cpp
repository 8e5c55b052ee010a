#include "survey/volumetric/volumetric_planner.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <sstream>
#include <string>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/points/point_grid.h"
#include "geometry/points/spaced_points.h"
#include "geometry/random_numbers.h"
#include "survey/stopwatch.h"
#include "survey/volumetric/volumetric_gain.h"

namespace skycap::survey::volumetric {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::ScanSpan;
using geometry::View;

/// Returns the ends of the rays of no-return pixels, at the distance `depth` from the sensor.
std::vector<Vector3f> compute_no_return_ends(const ScanSpan& scan, const geometry::Camera& camera,
                                             double depth) {
  std::vector<Vector3f> ends;
  const auto width = static_cast<std::uint32_t>(camera.width());
  const std::uint32_t pixels = width * static_cast<std::uint32_t>(camera.height());
  auto next_return = scan.pixels.begin();
  for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
    if (next_return != scan.pixels.end() && *next_return == pixel) {
      ++next_return;
      continue;
    }
    const Vector3d direction = camera.ray({pixel % width, pixel / width}).normalized();
    ends.push_back((scan.world_from_sensor * Vector3d(depth * direction)).cast<float>());
  }
  return ends;
}

}  // namespace

std::vector<View> sphere_views(std::size_t count, const Vector3d& centre, double radius,
                               const std::optional<double>& min_height, std::uint64_t seed) {
  geometry::RandomNumbers random(seed);
  std::normal_distribution<double> normal;
  std::vector<View> views;
  views.reserve(count);
  const std::size_t max_attempts = 1000 * count;
  for (std::size_t attempt = 0; views.size() < count; ++attempt) {
    if (attempt == max_attempts) {
      std::ostringstream message;
      message << "the top of the candidate sphere is at " << centre.z() + radius
              << " m; less than a thousandth of the sphere is above the minimum height of "
              << min_height.value_or(0.0) << " m; lower limits.ground_clearance";
      throw Error(ErrorKind::bad_config, message.str());
    }
    const double x = normal(random), y = normal(random), z = normal(random);
    const Vector3d direction(x, y, z);
    if (direction.norm() < 1e-3) continue;
    const Vector3d position = centre + radius * direction.normalized();
    if (min_height && position.z() < *min_height) continue;
    views.push_back(geometry::look_at(position, centre));
  }
  return views;
}

std::size_t select_best(std::span<const double> gains, std::span<const double> distances,
                        double cost_weight, TieRule ties) {
  const double all_gains = std::accumulate(gains.begin(), gains.end(), 0.0);
  const double all_distances = std::accumulate(distances.begin(), distances.end(), 0.0);
  std::size_t best = 0;
  double best_utility = 0.0;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    double utility = all_gains == 0.0 ? gains[i] : gains[i] / all_gains;
    if (all_distances > 0.0) utility -= cost_weight * distances[i] / all_distances;
    const bool wins_tie =
        ties == TieRule::nearest && utility == best_utility && distances[i] < distances[best];
    if (i == 0 || utility > best_utility || wins_tie) best = i, best_utility = utility;
  }
  return best;
}

struct VolumetricPlanner::Impl {
  struct Candidate {
    View view;
    double gain = 0.0;
  };

  Impl(const VolumetricConfig& given, const geometry::Camera& sensor)
      : config(given),
        camera(sensor),
        directions(ray_directions(camera, config.settings.rays)),
        map(config.resolution, config.shadow_length()),
        kept(config.spacing, std::max(2.0 * config.spacing, 1e-6)) {
    for (const View& view : sphere_views(config.candidates, config.sphere_centre,
                                         config.sphere_radius, config.min_height, config.seed)) {
      candidates.push_back({view});
    }
  }

  void insert(const ScanSpan& scan);
  void score();
  std::optional<View> pop_best();

  VolumetricConfig config;
  geometry::Camera camera;
  std::vector<Vector3d> directions;
  VolumetricMap map;
  geometry::SpacedPoints kept;
  geometry::PointCloud cloud;
  std::vector<Candidate> candidates;  // not yet proposed, in order of generation
  Vector3d position = Vector3d::Zero();
  std::uint32_t scans = 0;
  PlanningStep step;
  std::stop_token stop;
};

VolumetricPlanner::VolumetricPlanner(const VolumetricConfig& config, const geometry::Camera& camera)
    : impl_((config.validate(), std::make_unique<Impl>(config, camera))) {}

VolumetricPlanner::~VolumetricPlanner() = default;

void VolumetricPlanner::stop_on(const std::stop_token& stop) { impl_->stop = stop; }
const geometry::PointCloud& VolumetricPlanner::cloud() const { return impl_->cloud; }
geometry::PointCloud VolumetricPlanner::take_cloud() { return std::move(impl_->cloud); }
const PlanningStep& VolumetricPlanner::last_step() const { return impl_->step; }
const VolumetricMap& VolumetricPlanner::map() const { return impl_->map; }

std::optional<View> VolumetricPlanner::next_view(const ScanSpan& scan) {
  impl_->step = {};
  Stopwatch stopwatch(impl_->step.times);
  impl_->insert(scan);
  stopwatch.lap("insert");
  if (impl_->cloud.positions.empty()) {
    throw Error(ErrorKind::bad_geometry,
                "the first scan contains no point of the scene; start from a view that sees it, or "
                "enlarge planner.scene_box");
  }
  impl_->score();
  stopwatch.lap("score");
  return impl_->pop_best();
}

std::optional<View> VolumetricPlanner::next_alternative_view() { return impl_->pop_best(); }

void VolumetricPlanner::Impl::insert(const ScanSpan& scan) {
  position = scan.sensor_position();
  std::vector<Vector3f> measured;
  for (const Vector3f& point : scan.points) {
    if (config.scene_box && !config.scene_box->contains(point.cast<double>())) continue;
    const bool is_new = kept.keep(point);
    if (is_new) {
      cloud.positions.push_back(point);
      cloud.views.push_back(scans);
      ++step.points_new;
    }
    if (is_new || !config.settings.downsampled) measured.push_back(point);
  }
  ++scans;

  std::vector<Vector3f> empty_ends;
  if (config.settings.carve_no_returns && !scan.pixels.empty()) {
    empty_ends = compute_no_return_ends(scan, camera, config.ray_depth());
  }
  map.insert(position.cast<float>(), measured, empty_ends);
}

void VolumetricPlanner::Impl::score() {
  geometry::parallel_for(candidates.size(), config.threads, [&](std::size_t i) {
    if (stop.stop_requested()) throw Interrupted();
    candidates[i].gain = information_gain(config.metric, map, candidates[i].view, directions,
                                          config.ray_depth(), config.settings.gain);
  });
}

std::optional<View> VolumetricPlanner::Impl::pop_best() {
  if (candidates.empty()) return std::nullopt;
  std::vector<double> gains, distances;
  for (const Candidate& candidate : candidates) {
    gains.push_back(candidate.gain);
    distances.push_back((candidate.view.position - position).norm());
  }
  const std::size_t best =
      select_best(gains, distances, config.settings.cost_weight, config.settings.ties);
  const View view = candidates[best].view;
  candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(best));
  return view;
}

}  // namespace skycap::survey::volumetric
