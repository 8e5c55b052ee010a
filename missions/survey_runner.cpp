#include "missions/survey_runner.h"

#include <span>

#include "geometry/camera.h"
#include "geometry/parallel.h"
#include "missions/coverage.h"
#include "sim/depth_camera.h"

namespace skycap::missions {
namespace {

template <class Field>
double sum_over(const std::vector<JudgedView>& views, Field field) {
  double sum = 0.0;
  for (const JudgedView& view : views) sum += view.surveyed.*field;
  return sum;
}

}  // namespace

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
  const std::unique_ptr<survey::Planner> planner = make_planner(mission, threads);
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
  const survey::SurveyLimits limits{mission.limits.max_views, mission.limits.max_distance};
  record.stop_reason =
      survey::run_survey(*planner, scene.first_view(seed), limits, ports, std::move(stop))
          .stop_reason;
  record.cloud = planner->cloud();
  record.is_covered = meter.is_covered();
  return record;
}

}  // namespace skycap::missions
