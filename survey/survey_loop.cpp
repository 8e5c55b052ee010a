#include "survey/survey_loop.h"

#include <chrono>
#include <ctime>
#include <optional>
#include <utility>

#include "survey/stopwatch.h"

namespace skycap::survey {
namespace {

using geometry::View;

/// Runs `work` and adds its duration to `elapsed` [s].
template <typename Work>
auto timed(double& elapsed, Work work) {
  const auto start = std::chrono::steady_clock::now();
  auto result = work();
  elapsed += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

/// Returns the processor time of this thread [s].
double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Runs a planner function and adds its duration to the planning times.
template <typename Work>
auto planned(SurveyedView& surveyed_view, Work work) {
  const double begun = processor_time();
  auto result = timed(surveyed_view.planning_time, work);
  surveyed_view.planning_processor_time += processor_time() - begun;
  return result;
}

/// Adds the planning time that is not assigned to any part to `part`.
void record_remainder(SurveyedView& surveyed_view, const char* part) {
  double rest = surveyed_view.planning_time;
  for (const PartTime& time : surveyed_view.step.times) rest -= time.seconds;
  add_time(surveyed_view.step.times, part, rest);
}

}  // namespace

SurveyStepper::SurveyStepper(Planner& planner, const SurveyLimits& limits,
                             SurveyCallbacks callbacks)
    : planner_(planner), limits_(limits), callbacks_(std::move(callbacks)) {}

void SurveyStepper::pass(const geometry::Scan& scan, double sensing_time) {
  if (callbacks_.sensed_en_route) callbacks_.sensed_en_route(scan);
  coming_.sensing_time += sensing_time;
  coming_.en_route.views.push_back(geometry::to_view(scan.world_from_sensor));
  coming_.en_route.returns += scan.points.size();
  planned(coming_, [&] {
    planner_.pass(scan);
    return true;
  });
}

std::optional<View> SurveyStepper::add_scan(const geometry::Scan& scan, double sensing_time) {
  if (callbacks_.sensed) callbacks_.sensed(scan);
  SurveyedView surveyed_view = std::exchange(coming_, {});
  surveyed_view.sensing_time += sensing_time;
  surveyed_view.view = geometry::to_view(scan.world_from_sensor);
  if (!views_.empty()) {
    surveyed_view.distance =
        views_.back().distance + (surveyed_view.view.position - views_.back().view.position).norm();
  }
  std::optional<View> next = planned(surveyed_view, [&] { return planner_.next_view(scan); });
  surveyed_view.step = planner_.last_step();
  surveyed_view.planning_processor_time += surveyed_view.step.processor_time_elsewhere;
  record_remainder(surveyed_view, "rest");
  if (std::optional<View> given = next_initial_view(surveyed_view)) {
    next = std::move(given);
  } else {
    next = reachable(std::move(next), surveyed_view, false);
  }
  surveyed_view.points = planner_.cloud().size();
  surveyed_view.returns = scan.points.size();
  views_.push_back(std::move(surveyed_view));
  if (callbacks_.report) callbacks_.report(views_.back(), scan);
  return within_limits(std::move(next));
}

std::optional<View> SurveyStepper::next_initial_view(const SurveyedView& surveyed_view) {
  while (initial_views_done_ < callbacks_.initial_pattern.size()) {
    const View& view = callbacks_.initial_pattern[initial_views_done_++];
    if (!planner_.allows(view)) continue;
    if (!callbacks_.can_reach || callbacks_.can_reach(surveyed_view.view.position, view))
      return view;
  }
  return std::nullopt;
}

std::optional<View> SurveyStepper::reject() {
  SurveyedView& surveyed_view = views_.back();
  std::optional<View> next =
      planned(surveyed_view, [&] { return planner_.next_alternative_view(); });
  return within_limits(reachable(std::move(next), surveyed_view, true));
}

void SurveyStepper::stop_on(const std::stop_token& stop) {
  stop_ = stop;
  planner_.stop_on(stop);
  if (callbacks_.stop_on) callbacks_.stop_on(stop);
}

std::optional<View> SurveyStepper::reachable(std::optional<View> next, SurveyedView& surveyed_view,
                                             bool is_rejected) {
  while (next && callbacks_.can_reach &&
         !callbacks_.can_reach(surveyed_view.view.position, *next)) {
    if (stop_.stop_requested()) throw Interrupted();
    is_rejected = true;
    next = planned(surveyed_view, [&] { return planner_.next_alternative_view(); });
  }
  if (is_rejected) record_remainder(surveyed_view, "instead");
  if (!next) stop_reason_ = is_rejected ? StopReason::nowhere_to_go : planner_.stop_reason();
  return next;
}

std::optional<View> SurveyStepper::within_limits(std::optional<View> next) {
  if (!next) return std::nullopt;
  const SurveyedView& last = views_.back();
  const double travelled = (next->position - last.view.position).norm();
  const auto reason = broken_limit(limits_, {views_.size(), last.distance + travelled});
  if (!reason) return next;
  stop_reason_ = *reason;
  return std::nullopt;
}

namespace {

/// Takes the en-route scans between the last view and `next`, and reuses the memory of `buffer`.
/// Returns false if a stop was requested.
bool scanned_en_route(SurveyStepper& steps, const View& next, const SurveyCallbacks& callbacks,
                      geometry::Scan& buffer, const std::stop_token& stop) {
  if (!callbacks.en_route_views || steps.views().empty()) return true;
  for (const View& view : callbacks.en_route_views(steps.views().back().view, next)) {
    if (stop.stop_requested()) return false;
    double sensing_time = 0.0;
    buffer = timed(sensing_time, [&] { return callbacks.sense_en_route(view, std::move(buffer)); });
    steps.pass(buffer, sensing_time);
  }
  return true;
}

}  // namespace

SurveyResult run_survey(Planner& planner, const View& first_view, const SurveyLimits& limits,
                        const SurveyCallbacks& callbacks, std::stop_token stop) {
  SurveyStepper steps(planner, limits, callbacks);
  std::optional<View> next = first_view;
  geometry::Scan scan;
  while (next) {
    if (!scanned_en_route(steps, *next, callbacks, scan, stop)) {
      return {StopReason::interrupted, std::move(steps).views()};
    }
    double sensing_time = 0.0;
    scan = timed(sensing_time, [&] { return callbacks.sense(*next, std::move(scan)); });
    try {
      next = steps.add_scan(scan, sensing_time);
    } catch (const Interrupted&) {  // the last scan is not counted
      return {StopReason::interrupted, std::move(steps).views()};
    }
    if (next && stop.stop_requested()) {
      return {StopReason::interrupted, std::move(steps).views()};
    }
    steps.stop_on(stop);  // from here on, an interrupted survey has results
  }
  const StopReason reason = steps.stop_reason();
  return {reason, std::move(steps).views()};
}

}  // namespace skycap::survey
