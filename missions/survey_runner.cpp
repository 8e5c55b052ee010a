#include "missions/survey_runner.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "geometry/camera.h"
#include "geometry/error.h"
#include "geometry/parallel.h"
#include "missions/coverage.h"
#include "sim/depth_camera.h"

namespace skycap::missions {
namespace {

/// Keeps the candidates' random numbers apart from those of the first view.
constexpr std::uint64_t candidates_stream = 0x766f6c756d657472;

template <class Field>
double sum_over(const std::vector<JudgedView>& views, Field field) {
  double sum = 0.0;
  for (const JudgedView& view : views) sum += view.surveyed.*field;
  return sum;
}

/// A volumetric survey's V where neither mission nor benchmark says it: the paper's for its last
/// two models.
constexpr std::size_t usual_view_limit = 130;

std::size_t view_limit(const Mission& mission) {
  const bool is_volumetric = volumetric_metric(mission.planner.name).has_value();
  return is_volumetric ? std::min(mission.volumetric.view_limit.value_or(usual_view_limit),
                                  mission.limits.max_views)
                       : mission.limits.max_views;
}

survey::VolumetricConfig volumetric_config(const Mission& mission, survey::VolumetricMetric metric,
                                           unsigned threads) {
  const survey::VolumetricSettings& settings = mission.volumetric;
  if (!settings.sphere_centre || !settings.sphere_radius) {
    throw Error(ErrorKind::bad_config,
                "the planner needs volumetric.sphere_centre and volumetric.sphere_radius where "
                "there is no model to derive them from; give both");
  }
  const survey::SeeConfig& see = mission.planner.see;
  const double views = static_cast<double>(view_limit(mission)) * settings.candidates_per_view;
  return {.metric = metric,
          .resolution = see.resolution_radius,
          .spacing = see.effective_spacing(),
          .scene_box = see.scene_box,
          .candidates = static_cast<std::size_t>(std::lround(views)),
          .sphere_centre = *settings.sphere_centre,
          .sphere_radius = *settings.sphere_radius,
          .least_height = see.ground_clearance,
          .seed = mission.seed ^ candidates_stream,
          .settings = settings,
          .threads = threads};
}

/// The mission of one trial: what a volumetric planner takes from the scene is filled in.
Mission trial_mission(const Mission& mission, const SurveyScene& scene, std::uint64_t seed) {
  Mission trial = mission;
  trial.seed = seed;
  survey::VolumetricSettings& settings = trial.volumetric;
  if (!settings.sphere_centre) settings.sphere_centre = scene.view_sphere().centre;
  if (!settings.sphere_radius) settings.sphere_radius = scene.view_sphere().radius;
  return trial;
}

}  // namespace

std::optional<survey::VolumetricMetric> volumetric_metric(PlannerName name) {
  using enum survey::VolumetricMetric;
  switch (name) {
    case PlannerName::rsv:
      return rear_side_voxel;
    case PlannerName::rse:
      return rear_side_entropy;
    case PlannerName::oa:
      return occlusion_aware;
    case PlannerName::uv:
      return unobserved_voxel;
    case PlannerName::pc:
      return proximity_count;
    case PlannerName::af:
      return area_factor;
    case PlannerName::ae:
      return average_entropy;
    default:
      return std::nullopt;
  }
}

double SurveyRecord::planning_time() const {
  return sum_over(views, &survey::SurveyedView::planning_time);
}

double SurveyRecord::sensing_time() const {
  return sum_over(views, &survey::SurveyedView::sensing_time);
}

const char* name_of(survey::StopReason reason) {
  switch (reason) {
    case survey::StopReason::complete:
      return "complete";
    case survey::StopReason::view_limit:
      return "view_limit";
    case survey::StopReason::distance_limit:
      return "distance_limit";
    case survey::StopReason::nowhere_to_go:
      return "nowhere_to_go";
    case survey::StopReason::interrupted:
      break;
  }
  return "interrupted";
}

std::unique_ptr<survey::Planner> make_planner(const Mission& mission, unsigned threads) {
  const geometry::Camera camera(mission.sensor.camera.camera);
  survey::SeeConfig see = mission.planner.see;
  see.threads = threads;
  if (const auto metric = volumetric_metric(mission.planner.name)) {
    return std::make_unique<survey::VolumetricPlanner>(volumetric_config(mission, *metric, threads),
                                                       camera);
  }
  if (mission.planner.name != PlannerName::skycap) {
    return std::make_unique<survey::SeePlanner>(see, camera);
  }
  survey::SkycapConfig config{
      .coverage_radius = mission.evaluation.registration_distance,
      .spacing = see.effective_spacing(),
      .view_distance = see.view_distance.value_or(view_distance(camera, see.density)),
      .scene_box = see.scene_box,
      .stop = mission.planner.skycap_stop,
      .threads = threads};
  if (mission.limits.ground_clearance) config.limits.least_height = see.ground_clearance;
  return std::make_unique<survey::SkycapPlanner>(config, camera);
}

SurveyRecord run_survey(const Mission& mission, const SurveyScene& scene, std::uint64_t seed,
                        unsigned threads, std::stop_token stop,
                        const std::function<void(const JudgedView&)>& report) {
  sim::DepthCameraConfig camera_config = mission.sensor.camera;
  camera_config.noise.seed = seed;
  const sim::DepthCamera camera(camera_config);
  const std::unique_ptr<survey::Planner> planner =
      make_planner(trial_mission(mission, scene, seed), threads);
  CoverageMeter meter(scene.samples().points, mission.evaluation.registration_distance);

  SurveyRecord record;
  record.seed = seed;
  record.threads = geometry::thread_count(threads);
  std::uint64_t frame = 0;
  std::size_t points_judged = 0;
  survey::SurveyPorts ports;
  ports.sense = [&](const geometry::View& view) {
    return camera.scan(scene.scene(), view, frame++, threads);
  };
  ports.report = [&](const survey::SurveyedView& view, const geometry::Scan&) {
    const std::span stored(planner->cloud().positions);
    meter.add(stored.subspan(points_judged));
    points_judged = stored.size();
    record.views.push_back({view, meter.share()});
    if (report) report(record.views.back());
  };
  const survey::SurveyLimits limits{view_limit(mission), mission.limits.max_distance};
  record.stop_reason =
      survey::run_survey(*planner, scene.first_view(seed), limits, ports, std::move(stop))
          .stop_reason;
  record.cloud = planner->cloud();
  record.is_covered = meter.is_covered();
  return record;
}

}  // namespace skycap::missions
