#include "missions/simulation/planning_time.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <span>
#include <stop_token>
#include <thread>
#include <vector>

#include "geometry/pose/camera.h"
#include "geometry/surfaces/mesh.h"
#include "missions/evaluation/coverage.h"
#include "missions/evaluation/downsampled_cloud.h"
#include "missions/evaluation/evaluation.h"
#include "missions/simulation/omniscient.h"
#include "missions/simulation/survey_runner.h"
#include "sim/sensors/survey_sensor.h"
#include "survey/surfel/coverage_model.h"

namespace skycap::missions::simulation {
namespace {

using Clock = std::chrono::steady_clock;
using Eigen::Vector3d;

/// Limits of the survey that is run for its times.
constexpr std::chrono::seconds max_survey_time(3);
constexpr std::size_t max_survey_views = 8;

/// Number of surface samples from which the visible surface and its views are predicted.
constexpr std::size_t few_samples = 4000;

double seconds_since(Clock::time_point begun) {
  return std::chrono::duration<double>(Clock::now() - begun).count();
}

/// Requests a stop after a time, unless it is destroyed before.
class Alarm {
 public:
  explicit Alarm(std::chrono::seconds time)
      : thread_([this, time](const std::stop_token& ended) {
          std::unique_lock lock(mutex_);
          if (!wakes_.wait_for(lock, ended, time, [] { return false; }) &&
              !ended.stop_requested()) {
            source_.request_stop();
          }
        }) {}

  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::mutex mutex_;
  std::condition_variable_any wakes_;
  std::jthread thread_;  ///< last, because it uses the other members
};

/// Sets the times of the survey from its first scans.
void time_survey(const evaluation::SimulationOptions& options, const evaluation::SurveyScene& scene,
                 const session::RunOptions& run, PlanningPace& pace) {
  evaluation::SimulationOptions beginning = options;
  beginning.survey.limits.max_views = std::min(options.survey.limits.max_views, max_survey_views);
  const Alarm alarm(max_survey_time);
  const Clock::time_point begun = Clock::now();
  std::size_t counted = 0;
  const session::SurveyRecord record = run_survey(
      beginning, scene, run.seed, run.threads, alarm.token(), [&](const session::EvaluatedView&) {
        if (counted++ == 0) pace.start = seconds_since(begun);
      });
  const double all = seconds_since(begun);
  if (counted == 0) pace.start = all;
  const std::size_t further = record.scans.size() - std::min<std::size_t>(record.scans.size(), 1);
  pace.scan = further == 0 ? pace.start : (all - pace.start) / static_cast<double>(further);
}

/// Returns the time of a scan with the evaluation of its coverage [s].
double time_measurement(const evaluation::SimulationOptions& options,
                        const evaluation::SurveyScene& scene, const session::RunOptions& run) {
  const sim::SurveySensor sensor(options.sensor, run.seed);
  const geometry::View view = scene.first_view(run.seed);
  evaluation::CoverageMeter meter(scene.samples().points, options.evaluation.registration_distance);
  evaluation::DownsampledCloud cloud(options.survey.planner.spacing);
  const Clock::time_point begun = Clock::now();
  const geometry::Scan scan = sensor.scan(scene.scene(), view, 0, run.threads);
  meter.add(cloud.store(scan.points, options.scene_box()));
  return seconds_since(begun);
}

/// Returns evenly selected samples of the surface.
geometry::SurfaceSamples select_samples(const geometry::SurfaceSamples& all, std::size_t count) {
  const std::size_t step = std::max<std::size_t>(1, all.points.size() / count);
  geometry::SurfaceSamples selected;
  for (std::size_t i = 0; i < all.points.size(); i += step) {
    selected.points.push_back(all.points[i]);
    selected.normals.push_back(all.normals[i]);
  }
  return selected;
}

/// Surface samples that a scan covers, predicted from the ground-truth surface.
class PredictedScan {
 public:
  PredictedScan(const evaluation::SimulationOptions& options, const evaluation::SurveyScene& scene,
                const geometry::SurfaceSamples& samples)
      : scene_(scene.scene()),
        samples_(samples),
        clearance_(scene.admissible().clearance),
        camera_(options.sensor.camera.camera),
        min_cosine_(std::cos(options.sensor.camera.max_incidence)),
        coverage_model_(options.evaluation.registration_distance,
                        true_noise(options.sensor.camera.noise)),
        uncovered_(samples.points.size(), 1.0F) {}

  /// Adds a scan. Returns the samples that all scans so far probably cover.
  geometry::Scan add(const geometry::View& view) {
    const Eigen::Isometry3d camera_from_world = geometry::camera_pose(view).inverse();
    geometry::Scan scan;
    for (std::size_t i = 0; i < samples_.points.size(); ++i) {
      if (uncovered_[i] < probably_covered) continue;
      const Vector3d point = samples_.points[i].cast<double>();
      const Vector3d towards = view.position - point;
      const double distance = towards.norm();
      const double cosine = samples_.normals[i].cast<double>().dot(towards) / distance;
      const Vector3d in_camera = camera_from_world * point;
      if (cosine <= min_cosine_ || !camera_.project(in_camera)) continue;
      if (scene_.is_blocked(view.position, point + clearance_ * towards / distance)) continue;
      const double depth = in_camera.z();
      const double density =
          camera_.focal_length_px().prod() * cosine * distance / (depth * depth * depth);
      uncovered_[i] *= std::exp(
          -coverage_model_.hazard(static_cast<float>(density), static_cast<float>(cosine)));
      if (uncovered_[i] < probably_covered) scan.points.push_back(samples_.points[i]);
    }
    return scan;
  }

 private:
  static constexpr float probably_covered = 0.5F;

  const sim::Scene& scene_;
  const geometry::SurfaceSamples& samples_;
  double clearance_;
  geometry::Camera camera_;
  double min_cosine_;
  survey::surfel::CoverageModel coverage_model_;
  std::vector<float> uncovered_;  ///< probability of each sample
};

/// Scans of attainable_samples() for a part of the samples of the scene.
struct AttainableScans {
  std::size_t all = 0;
  std::size_t useless = 0;  ///< that cover no sample, not even the one they are aimed at
};

AttainableScans count_attainable_scans(const evaluation::SimulationOptions& options,
                                       const evaluation::SurveyScene& scene,
                                       const geometry::SurfaceSamples& samples,
                                       std::span<const std::uint8_t> is_visible,
                                       const session::RunOptions& run) {
  PredictedScan predicted(options, scene, samples);
  AttainableScans scans;
  const auto scan = [&](const geometry::View& view, std::uint64_t, geometry::Scan) {
    geometry::Scan covered = predicted.add(view);
    ++scans.all;
    if (covered.points.empty()) ++scans.useless;
    return covered;
  };
  const evaluation::AttainableConfig config{
      .views = options.evaluation.attainable_views,
      .spacing = 0.1 * options.evaluation.registration_distance,
      .registration_distance = options.evaluation.registration_distance,
      .box = options.scene_box(),
      .seed = run.seed};
  evaluation::attainable_samples(samples.points, is_visible, scene.scene(), scan,
                                 scene.admissible(), config);
  return scans;
}

}  // namespace

PlanningPace measure_pace(const evaluation::SimulationOptions& options,
                          const evaluation::SurveyScene& scene, const session::RunOptions& run) {
  PlanningPace pace;
  time_survey(options, scene, run, pace);
  pace.measurement = time_measurement(options, scene, run);

  const geometry::SurfaceSamples samples = select_samples(scene.samples(), few_samples);
  const Clock::time_point begun = Clock::now();
  const std::vector<std::uint8_t> is_visible =
      evaluation::visible_samples(samples.points, scene.scene(), scene.admissible(), run.threads);
  pace.visible = seconds_since(begun) * static_cast<double>(scene.samples().points.size()) /
                 static_cast<double>(samples.points.size());
  const AttainableScans scans = count_attainable_scans(options, scene, samples, is_visible, run);
  // All samples of the scene need more scans than a part of them. If some cannot be covered, up to
  // all permitted scans are taken in vain.
  const auto limit = static_cast<double>(options.evaluation.attainable_views);
  const auto counted = static_cast<double>(scans.all);
  pace.attainable = pace.measurement * counted;
  pace.max_attainable =
      pace.measurement * (scans.useless > 0 ? limit : std::min(limit, 2.0 * counted));
  return pace;
}

double planning_time(const PlanningPace& pace, const SurveyWork& work, double attainable,
                     bool has_vehicle) {
  // Normals, files and report, from plans of the shipped missions [s].
  constexpr double results = 0.5, a_point = 4e-6;
  const double survey = pace.start + pace.scan * std::max(0.0, work.scans - 1.0);
  // The written files are flown again.
  const double flown = has_vehicle ? work.scans * pace.measurement : 0.0;
  return survey + pace.visible + attainable + flown + results + a_point * work.points;
}

}  // namespace skycap::missions::simulation
