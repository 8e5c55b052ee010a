#include "missions/run/survey_runner.h"

#include <span>
#include <utility>
#include <vector>

#include "geometry/parallel.h"
#include "missions/derived/opening_flight.h"
#include "missions/derived/survey_sensor.h"
#include "missions/judge/coverage.h"
#include "missions/run/mission_planner.h"

namespace skycap::missions::run {

file::Mission trial_mission(const file::Mission& mission, const scene::SurveyScene& scene,
                            std::uint64_t seed) {
  file::Mission trial = mission;
  trial.seed = seed;
  survey::volumetric::VolumetricSettings& settings = trial.volumetric;
  if (!settings.sphere_centre) settings.sphere_centre = scene.view_sphere().centre;
  if (!settings.sphere_radius) settings.sphere_radius = scene.view_sphere().radius;
  return trial;
}

SurveyRecord run_survey(const file::Mission& mission, const scene::SurveyScene& scene,
                        std::uint64_t seed, unsigned threads, std::stop_token stop,
                        const std::function<void(const JudgedView&)>& report,
                        SurveyJournal* journal) {
  const derived::SurveySensor sensor(mission.sensor, seed);
  std::vector<geometry::View> opening = derived::opening_views(trial_mission(mission, scene, seed));
  const geometry::View first_view = opening.empty() ? scene.first_view(seed) : opening.front();
  MissionPlanner guided(trial_mission(mission, scene, seed), first_view, threads);
  judge::CoverageMeter meter(scene.samples().points, mission.evaluation.registration_distance);
  SurveyRecord record;
  record.seed = seed;
  record.threads = geometry::thread_count(threads);

  std::uint64_t frame = 0;
  std::size_t points_judged = 0;
  survey::SurveyPorts ports = guided.ports();
  if (!opening.empty()) ports.opening.assign(opening.begin() + 1, opening.end());
  ports.sense = [&](const geometry::View& view, geometry::Scan recycled) {
    record.scans.push_back({static_cast<std::uint32_t>(record.views.size()), view.position});
    return sensor.scan(scene.scene(), view, frame++, threads, std::move(recycled));
  };
  ports.sense_on_way = ports.sense;
  if (!mission.flight.is_flown()) {  // else ways there are proven as measured
    ports.can_reach = [&scene, allows = std::move(ports.can_reach)](const Eigen::Vector3d& from,
                                                                    const geometry::View& view) {
      return (!allows || allows(from, view)) && scene.is_reachable(view.position);
    };
  }
  ports.report = [&](const survey::SurveyedView& view, const geometry::Scan&) {
    const std::span stored(guided.planner().cloud().positions);
    meter.add(stored.subspan(points_judged));
    points_judged = stored.size();
    record.views.push_back({view, meter.share()});
    if (report) report(record.views.back());
  };
  if (journal != nullptr) journal->attach(ports, guided.flight());
  record.stop_reason =
      survey::run_survey(guided.planner(), first_view, guided.limits(), ports, std::move(stop))
          .stop_reason;
  guided.finish(record);
  // Less what came after the last view, if planning was interrupted.
  record.cloud.positions.resize(points_judged);
  record.cloud.views.resize(points_judged);
  record.is_covered = meter.is_covered();
  return record;
}

}  // namespace skycap::missions::run
