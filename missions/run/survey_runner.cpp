#include "missions/run/survey_runner.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "geometry/parallel.h"
#include "geometry/points/point_grid.h"
#include "missions/derived/planner_factory.h"
#include "missions/derived/site.h"
#include "missions/derived/survey_sensor.h"
#include "missions/judge/coverage.h"

namespace skycap::missions::run {
namespace {

template <class Field>
double sum_over(const std::vector<JudgedView>& views, Field field) {
  double sum = 0.0;
  for (const JudgedView& view : views) sum += view.surveyed.*field;
  return sum;
}

/// Takes over what only the planner skycap can say, such as which budget made it stop.
void record_belief(const survey::Planner& planner, SurveyRecord& record) {
  const auto* skycap = dynamic_cast<const survey::skycap::SkycapPlanner*>(&planner);
  if (skycap == nullptr) return;
  record.belief = skycap->belief();
  record.skycap_stop = skycap->stop();
  if (!record.is_complete()) return;
  if (record.skycap_stop == survey::skycap::SkycapStop::most_length) {
    record.stop_reason = survey::StopReason::distance_limit;
  } else if (record.skycap_stop == survey::skycap::SkycapStop::most_time) {
    record.stop_reason = survey::StopReason::time_limit;
  }
}

/// Keeps planners that know nothing of the mission's limits from breaking them.
class ViewGate {
 public:
  explicit ViewGate(const survey::ViewLimits& limits)
      : limits_(limits), grid_(std::max(limits.stand_off, 1e-3)) {}

  void add(std::span<const Eigen::Vector3f> measured) {
    if (limits_.stand_off == 0.0) return;
    for (const Eigen::Vector3f& point : measured) grid_.insert(point);
  }

  bool admits(const geometry::View& view) const {
    return limits_.allow(view) &&
           (limits_.stand_off == 0.0 ||
            !grid_.any_within(view.position.cast<float>(), limits_.stand_off));
  }

 private:
  survey::ViewLimits limits_;
  geometry::PointGrid grid_;
};

constexpr double seconds_per_minute = 60.0;

survey::SurveyLimits survey_limits(const file::Mission& mission) {
  const file::LimitsConfig& config = mission.limits;
  survey::SurveyLimits limits{.max_views = derived::view_limit(mission),
                              .max_distance = config.max_distance,
                              .speed = config.speed,
                              .time_per_view = config.time_per_view};
  if (config.max_minutes) limits.max_time = seconds_per_minute * *config.max_minutes;
  return limits;
}

/// The mission of one trial: what a volumetric planner takes from the scene is filled in.
file::Mission trial_mission(const file::Mission& mission, const scene::SurveyScene& scene,
                            std::uint64_t seed) {
  file::Mission trial = mission;
  trial.seed = seed;
  survey::volumetric::VolumetricSettings& settings = trial.volumetric;
  if (!settings.sphere_centre) settings.sphere_centre = scene.view_sphere().centre;
  if (!settings.sphere_radius) settings.sphere_radius = scene.view_sphere().radius;
  return trial;
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
    case survey::StopReason::time_limit:
      return "time_limit";
    case survey::StopReason::nowhere_to_go:
      return "nowhere_to_go";
    case survey::StopReason::interrupted:
      break;
  }
  return "interrupted";
}

const char* name_of(survey::skycap::SkycapStop stop) {
  switch (stop) {
    case survey::skycap::SkycapStop::wanted_coverage:
      return "wanted_coverage";
    case survey::skycap::SkycapStop::little_gain:
      return "little_gain";
    case survey::skycap::SkycapStop::most_length:
      return "most_length";
    case survey::skycap::SkycapStop::most_time:
      return "most_time";
    case survey::skycap::SkycapStop::nothing_in_reach:
      return "nothing_in_reach";
    case survey::skycap::SkycapStop::running:
      break;
  }
  return "running";
}

SurveyRecord run_survey(const file::Mission& mission, const scene::SurveyScene& scene,
                        std::uint64_t seed, unsigned threads, std::stop_token stop,
                        const std::function<void(const JudgedView&)>& report,
                        SurveyJournal* journal) {
  const derived::SurveySensor sensor(mission.sensor, seed);
  const std::unique_ptr<survey::Planner> planner =
      derived::make_planner(trial_mission(mission, scene, seed), threads);
  judge::CoverageMeter meter(scene.samples().points, mission.evaluation.registration_distance);

  SurveyRecord record;
  record.seed = seed;
  record.threads = geometry::thread_count(threads);
  const geometry::View first_view = scene.first_view(seed);
  std::optional<SurveyFlight> flight;
  if (mission.flight.is_flown()) flight.emplace(mission, first_view);

  std::uint64_t frame = 0;
  std::size_t points_judged = 0;
  survey::SurveyPorts ports;
  ports.sense = [&](const geometry::View& view, geometry::Scan recycled) {
    return sensor.scan(scene.scene(), view, frame++, threads, std::move(recycled));
  };
  ViewGate gate(derived::view_limits(mission));
  std::size_t points_gated = 0;
  const bool is_gated = mission.planner.name != file::PlannerName::skycap;
  if (flight) {
    ports.sensed = [&](const geometry::Scan& scan) {
      flight->fly();
      flight->take_in(scan);
    };
  }
  if (flight || is_gated) {
    ports.can_reach = [&](const Eigen::Vector3d& from, const geometry::View& view) {
      if (is_gated) {
        const std::span stored(planner->cloud().positions);
        gate.add(stored.subspan(points_gated));
        points_gated = stored.size();
        if (!gate.admits(view)) return false;
      }
      return !flight || flight->can_reach(from, view);
    };
  }
  ports.report = [&](const survey::SurveyedView& view, const geometry::Scan&) {
    const std::span stored(planner->cloud().positions);
    meter.add(stored.subspan(points_judged));
    points_judged = stored.size();
    record.views.push_back({view, meter.share()});
    if (report) report(record.views.back());
  };
  if (journal != nullptr) journal->attach(ports, flight ? &*flight : nullptr);
  const survey::SurveyLimits limits = survey_limits(mission);
  record.stop_reason =
      survey::run_survey(*planner, first_view, limits, ports, std::move(stop)).stop_reason;
  record_belief(*planner, record);
  record.cloud = planner->release_cloud();
  record.is_covered = meter.is_covered();
  if (flight) record.flown = flight->finish();
  return record;
}

}  // namespace skycap::missions::run
