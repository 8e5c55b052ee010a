#include "missions/simulation/omniscient.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "geometry/parallel.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/pose.h"
#include "geometry/random_numbers.h"
#include "missions/evaluation/coverage.h"
#include "missions/evaluation/evaluation.h"
#include "missions/simulation/measurement.h"
#include "sim/sensors/depth_camera.h"
#include "survey/surfel/coverage_model.h"

namespace skycap::missions::simulation {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::View;

// Gives other samples than those of the coverage measurement.
constexpr std::uint64_t sample_seed = 2;

/// Sample observed by a candidate, and the hazard of the observation.
struct Observation {
  std::uint32_t sample;
  float hazard;
};

/// Evaluation of views with the ground-truth surface.
class Truth {
 public:
  Truth(const evaluation::SimulationOptions& options, const evaluation::SurveyScene& scene,
        std::size_t sample_count, unsigned threads)
      : scene_(scene),
        admissible_(scene.admissible()),
        camera_(options.sensor.camera.camera),
        min_cosine_(std::cos(options.sensor.camera.max_incidence)),
        coverage_model_(options.evaluation.registration_distance,
                        true_noise(options.sensor.camera.noise)) {
    const geometry::SurfaceSamples all =
        geometry::sample_surface(scene.model(), sample_count, sample_seed);
    const std::vector<std::uint8_t> is_visible =
        evaluation::visible_samples(all.points, scene.scene(), admissible_, threads);
    for (std::size_t i = 0; i < all.points.size(); ++i) {
      if (!is_visible[i]) continue;
      points_.push_back(all.points[i]);
      normals_.push_back(all.normals[i]);
    }
  }

  std::size_t size() const { return points_.size(); }

  /// Returns admissible views, each aimed at a random sample.
  std::vector<View> candidates(std::size_t count, std::uint64_t seed) const {
    const std::vector<Vector3d> directions =
        evaluation::fibonacci_directions(admissible_.directions);
    geometry::RandomNumbers random(seed);
    std::vector<View> views;
    for (std::size_t i = 0; i < count && !points_.empty(); ++i) {
      const Vector3d target = points_[random() % points_.size()].cast<double>();
      const auto position = evaluation::free_position(
          target, directions, random() % directions.size(), scene_.scene(), admissible_);
      if (position) views.push_back(geometry::look_at(*position, target));
    }
    return views;
  }

  std::vector<Observation> observations(const View& view) const {
    const Eigen::Isometry3d camera_from_world = geometry::camera_pose(view).inverse();
    std::vector<Observation> observations;
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const Vector3d point = points_[i].cast<double>(), normal = normals_[i].cast<double>();
      const Vector3d towards = view.position - point;
      const double distance = towards.norm(), cosine = normal.dot(towards) / distance;
      if (cosine <= min_cosine_) continue;
      const Vector3d in_camera = camera_from_world * point;
      if (!camera_.project(in_camera)) continue;
      if (scene_.scene().is_blocked(view.position,
                                    point + admissible_.clearance * towards / distance)) {
        continue;
      }
      const double depth = in_camera.z();
      const double density =
          camera_.focal_length_px().prod() * cosine * distance / (depth * depth * depth);
      observations.push_back(
          {i, coverage_model_.hazard(static_cast<float>(density), static_cast<float>(cosine))});
    }
    return observations;
  }

 private:
  const evaluation::SurveyScene& scene_;
  evaluation::Admissible admissible_;
  geometry::Camera camera_;
  double min_cosine_;
  survey::surfel::CoverageModel coverage_model_;
  std::vector<Vector3f> points_, normals_;
};

/// Returns the expected number of newly covered samples, given the uncovered fractions after
/// previous observations.
double compute_gain(const std::vector<Observation>& observations,
                    const std::vector<float>& uncovered) {
  double gain = 0.0;
  for (const Observation& observation : observations)
    gain += uncovered[observation.sample] * (1.0F - std::exp(-observation.hazard));
  return gain;
}

void cover(const std::vector<Observation>& observations, std::vector<float>& uncovered) {
  for (const Observation& observation : observations)
    uncovered[observation.sample] *= std::exp(-observation.hazard);
}

/// Returns a short open tour from the first view through all others: nearest neighbour, then 2-opt.
std::vector<std::size_t> short_tour(const std::vector<View>& views) {
  const auto distance = [&](std::size_t a, std::size_t b) {
    return (views[a].position - views[b].position).norm();
  };
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = 0; i + 2 < order.size(); ++i) {
    const auto nearest =
        std::ranges::min_element(order.begin() + static_cast<std::ptrdiff_t>(i) + 1, order.end(),
                                 {}, [&](std::size_t k) { return distance(order[i], k); });
    std::swap(order[i + 1], *nearest);
  }
  for (bool is_better = true; is_better;) {
    is_better = false;
    for (std::size_t i = 1; i + 1 < order.size(); ++i) {
      for (std::size_t j = i + 1; j < order.size(); ++j) {
        const double tail = j + 1 < order.size() ? distance(order[j], order[j + 1]) : 0.0;
        const double turned_tail = j + 1 < order.size() ? distance(order[i], order[j + 1]) : 0.0;
        const double change = distance(order[i - 1], order[j]) + turned_tail -
                              distance(order[i - 1], order[i]) - tail;
        if (change >= -1e-9) continue;
        std::reverse(order.begin() + static_cast<std::ptrdiff_t>(i),
                     order.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        is_better = true;
      }
    }
  }
  return order;
}

/// Returns the views of the greedy cover, starting with the first view.
std::vector<View> greedy_cover(const evaluation::SimulationOptions& options,
                               const evaluation::SurveyScene& scene, std::uint64_t seed,
                               unsigned threads, const OmniscientConfig& config,
                               const std::stop_token& stop, survey::StopReason& reason) {
  const Truth truth(options, scene, config.samples, threads);
  std::vector<View> candidates = truth.candidates(config.candidates, seed);
  candidates.push_back(scene.first_view(seed));
  std::vector<std::vector<Observation>> observations(candidates.size());
  geometry::parallel_for(candidates.size(), threads, [&](std::size_t i) {
    observations[i] = truth.observations(candidates[i]);
  });

  const double min_gain = options.oracle.min_gain * static_cast<double>(truth.size());
  std::vector<float> uncovered(truth.size(), 1.0F);
  std::optional<Measurement> measured;
  if (config.target_coverage) measured.emplace(options, scene, seed, threads);
  std::vector<View> views;
  std::size_t next = candidates.size() - 1;
  reason = survey::StopReason::complete;
  while (true) {
    if (measured) measured->measure(candidates[next], views.size());
    views.push_back(candidates[next]);
    cover(observations[next], uncovered);
    if (measured && measured->meter().share() >= *config.target_coverage) break;
    if (views.size() >= options.oracle.max_views) reason = survey::StopReason::view_limit;
    if (stop.stop_requested()) reason = survey::StopReason::interrupted;
    if (reason != survey::StopReason::complete) break;

    double best = 0.0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const double gain = compute_gain(observations[i], uncovered);
      if (gain > best) best = gain, next = i;
    }
    if (best <= 0.0 || (!config.target_coverage && best < min_gain)) break;
  }
  return views;
}

}  // namespace

survey::surfel::Noise true_noise(const sim::NoiseConfig& noise) {
  return noise.direction == sim::NoiseDirection::isotropic
             ? survey::surfel::Noise{.isotropic = noise.sigma, .along_ray = 0.0}
             : survey::surfel::Noise{.isotropic = 0.0, .along_ray = noise.sigma};
}

std::vector<View> known_cover(const evaluation::SimulationOptions& options,
                              const evaluation::SurveyScene& scene, std::uint64_t seed,
                              unsigned threads, const OmniscientConfig& config) {
  survey::StopReason reason{};
  const std::vector<View> views = greedy_cover(options, scene, seed, threads, config, {}, reason);
  std::vector<View> tour;
  for (const std::size_t i : short_tour(views)) tour.push_back(views[i]);
  return tour;
}

session::SurveyRecord survey_omnisciently(const evaluation::SimulationOptions& options,
                                          const evaluation::SurveyScene& scene, std::uint64_t seed,
                                          unsigned threads, const OmniscientConfig& config,
                                          std::stop_token stop) {
  session::SurveyRecord record;
  record.seed = seed;
  record.threads = geometry::thread_count(threads);
  const std::vector<View> views =
      greedy_cover(options, scene, seed, threads, config, stop, record.stop_reason);

  Measurement measured(options, scene, seed, threads);
  double distance = 0.0;
  for (const std::size_t i : short_tour(views)) {
    session::EvaluatedView evaluated;
    evaluated.surveyed.view = views[i];
    if (!record.views.empty()) {
      distance += (views[i].position - record.views.back().surveyed.view.position).norm();
    }
    evaluated.surveyed.distance = distance;
    for (const Vector3f& point : measured.measure(views[i], i)) {
      record.cloud.positions.push_back(point);
      record.cloud.views.push_back(static_cast<std::uint32_t>(record.views.size()));
      ++evaluated.surveyed.step.points_new;
    }
    evaluated.surveyed.points = record.cloud.size();
    evaluated.coverage = measured.meter().share();
    record.views.push_back(std::move(evaluated));
  }
  record.is_covered = measured.meter().is_covered();
  return record;
}

}  // namespace skycap::missions::simulation
