#include "missions/simulation/survey_runner.h"

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/parallel.h"
#include "missions/evaluation/coverage.h"
#include "missions/session/constrained_planner.h"
#include "missions/simulation/mounted_sensor.h"

namespace skycap::missions::simulation {

namespace {

/// Time and motion of the sensor during a survey.
class SurveyClock {
 public:
  /// `flight` may be null; views then take no time.
  explicit SurveyClock(const session::SurveyFlight* flight) : flight_(flight) {}

  /// Returns the en-route views of the next path.
  std::vector<geometry::View> begin_leg(const geometry::View& from, const geometry::View& to) {
    frames_ = flight_->frames(from, to);
    next_frame_ = 0;
    std::vector<geometry::View> views;
    for (const session::ViewInFlight& frame : frames_) views.push_back(frame.view);
    return views;
  }

  /// Returns the next en-route view.
  session::ViewInFlight en_route() {
    session::ViewInFlight frame = frames_.at(next_frame_++);
    frame.time += now_;
    return frame;
  }

  session::ViewInFlight at(const geometry::View& view) {
    if (flight_ != nullptr && last_) now_ += flight_->time(*last_, view);
    last_ = view;
    return {.view = view, .time = now_};
  }

 private:
  const session::SurveyFlight* flight_;
  std::vector<session::ViewInFlight> frames_;
  std::size_t next_frame_ = 0;
  std::optional<geometry::View> last_;
  double now_ = 0.0;
};

}  // namespace

session::SurveyRecord run_survey(const evaluation::SimulationOptions& options,
                                 const evaluation::SurveyScene& scene, std::uint64_t seed,
                                 unsigned threads, std::stop_token stop,
                                 const std::function<void(const session::EvaluatedView&)>& report,
                                 SurveyJournal* journal) {
  MountedSensor sensor(options, seed);
  const geometry::View first_view = scene.first_view(seed, options.survey.planner);
  session::ConstrainedPlanner guided(
      options.survey, first_view,
      {.seed = seed,
       .threads = threads,
       .sphere = scene.view_sphere(),
       .true_scene_admits = scene.admissible().allows,
       .pattern_target = scene.pattern_target(options.survey.planner)});
  evaluation::CoverageMeter meter(scene.samples().points, options.evaluation.registration_distance);
  session::SurveyRecord record;
  record.seed = seed;
  record.threads = geometry::thread_count(threads);

  std::uint64_t frame = 0;
  std::size_t evaluated_points = 0;
  survey::SurveyCallbacks callbacks = guided.callbacks();
  SurveyClock clock(guided.flight());
  const auto sense = [&](const session::ViewInFlight& view, geometry::Scan buffer) {
    record.scans.push_back({static_cast<std::uint32_t>(record.views.size()), view.view.position});
    return sensor.scan(scene.scene(), view, frame++, threads, std::move(buffer));
  };
  callbacks.sense = [&](const geometry::View& view, geometry::Scan buffer) {
    return sense(clock.at(view), std::move(buffer));
  };
  callbacks.sense_en_route = [&](const geometry::View&, geometry::Scan buffer) {
    return sense(clock.en_route(), std::move(buffer));
  };
  if (callbacks.en_route_views) {
    callbacks.en_route_views = [&clock](const geometry::View& from, const geometry::View& to) {
      return clock.begin_leg(from, to);
    };
  }
  // With a vehicle, paths are verified in the measured space instead.
  if (guided.flight() == nullptr) {
    callbacks.can_reach = [&scene](const Eigen::Vector3d&, const geometry::View& view) {
      return scene.is_reachable(view.position);
    };
  }
  callbacks.report = [&](const survey::SurveyedView& view, const geometry::Scan&) {
    const std::span stored(guided.planner().cloud().positions);
    meter.add(stored.subspan(evaluated_points));
    evaluated_points = stored.size();
    record.views.push_back({view, meter.share()});
    if (report) report(record.views.back());
  };
  if (journal != nullptr) journal->attach(callbacks, guided.flight(), guided.planner());
  record.stop_reason =
      survey::run_survey(guided.planner(), first_view, guided.limits(), callbacks, std::move(stop))
          .stop_reason;
  guided.finish(record);
  // Removes points measured after the last view if planning was interrupted.
  record.cloud.positions.resize(evaluated_points);
  record.cloud.views.resize(evaluated_points);
  record.is_covered = meter.is_covered();
  return record;
}

}  // namespace skycap::missions::simulation
