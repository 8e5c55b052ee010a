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
auto planned(SurveyedView& taken, Work work) {
  const double begun = processor_time();
  auto result = timed(taken.planning_time, work);
  taken.planning_processor_time += processor_time() - begun;
  return result;
}

/// Adds the planning time that is not assigned to any part to `part`.
void book_rest(SurveyedView& taken, const char* part) {
  double rest = taken.planning_time;
  for (const PartTime& time : taken.step.times) rest -= time.seconds;
  add_time(taken.step.times, part, rest);
}

}  // namespace

SurveySteps::SurveySteps(Planner& planner, const SurveyLimits& limits, SurveyPorts ports)
    : planner_(planner), limits_(limits), ports_(std::move(ports)) {}

void SurveySteps::pass(const geometry::Scan& scan, double sensing_time) {
  if (ports_.sensed_on_way) ports_.sensed_on_way(scan);
  coming_.sensing_time += sensing_time;
  coming_.on_way.views.push_back(geometry::view_of(scan.world_from_sensor));
  coming_.on_way.returns += scan.points.size();
  planned(coming_, [&] {
    planner_.pass(scan);
    return true;
  });
}

std::optional<View> SurveySteps::take_in(const geometry::Scan& scan, double sensing_time) {
  if (ports_.sensed) ports_.sensed(scan);
  SurveyedView taken = std::exchange(coming_, {});
  taken.sensing_time += sensing_time;
  taken.view = geometry::view_of(scan.world_from_sensor);
  if (!views_.empty()) {
    taken.distance =
        views_.back().distance + (taken.view.position - views_.back().view.position).norm();
  }
  std::optional<View> next = planned(taken, [&] { return planner_.next_view(scan); });
  taken.step = planner_.last_step();
  book_rest(taken, "rest");
  if (std::optional<View> given = opening_view(taken)) {
    next = std::move(given);
  } else {
    next = reachable(std::move(next), taken, false);
  }
  taken.points = planner_.cloud().size();
  taken.returns = scan.points.size();
  views_.push_back(std::move(taken));
  if (ports_.report) ports_.report(views_.back(), scan);
  return within_limits(std::move(next));
}

std::optional<View> SurveySteps::opening_view(const SurveyedView& taken) {
  while (opened_ < ports_.opening.size()) {
    const View& view = ports_.opening[opened_++];
    if (!planner_.allows(view)) continue;
    if (!ports_.can_reach || ports_.can_reach(taken.view.position, view)) return view;
  }
  return std::nullopt;
}

std::optional<View> SurveySteps::refuse() {
  SurveyedView& taken = views_.back();
  std::optional<View> next = planned(taken, [&] { return planner_.next_view_instead(); });
  return within_limits(reachable(std::move(next), taken, true));
}

void SurveySteps::stop_on(const std::stop_token& stop) {
  stop_ = stop;
  planner_.stop_on(stop);
  if (ports_.stop_on) ports_.stop_on(stop);
}

std::optional<View> SurveySteps::reachable(std::optional<View> next, SurveyedView& taken,
                                           bool is_refused) {
  while (next && ports_.can_reach && !ports_.can_reach(taken.view.position, *next)) {
    if (stop_.stop_requested()) throw Interrupted();
    is_refused = true;
    next = planned(taken, [&] { return planner_.next_view_instead(); });
  }
  if (is_refused) book_rest(taken, "instead");
  if (!next) stop_reason_ = is_refused ? StopReason::nowhere_to_go : planner_.stop_reason();
  return next;
}

std::optional<View> SurveySteps::within_limits(std::optional<View> next) {
  if (!next) return std::nullopt;
  const SurveyedView& last = views_.back();
  const double way = (next->position - last.view.position).norm();
  const auto reason = broken_limit(limits_, {views_.size(), last.distance + way});
  if (!reason) return next;
  stop_reason_ = *reason;
  return std::nullopt;
}

namespace {

/// Takes the en-route scans between the last view and `next`, and reuses the memory of `recycled`.
/// Returns false if a stop was requested.
bool scanned_on_way(SurveySteps& steps, const View& next, const SurveyPorts& ports,
                    geometry::Scan& recycled, const std::stop_token& stop) {
  if (!ports.views_on_way || steps.views().empty()) return true;
  for (const View& view : ports.views_on_way(steps.views().back().view, next)) {
    if (stop.stop_requested()) return false;
    double sensing_time = 0.0;
    recycled = timed(sensing_time, [&] { return ports.sense_on_way(view, std::move(recycled)); });
    steps.pass(recycled, sensing_time);
  }
  return true;
}

}  // namespace

SurveyResult run_survey(Planner& planner, const View& first_view, const SurveyLimits& limits,
                        const SurveyPorts& ports, std::stop_token stop) {
  SurveySteps steps(planner, limits, ports);
  std::optional<View> next = first_view;
  geometry::Scan scan;
  while (next) {
    if (!scanned_on_way(steps, *next, ports, scan, stop)) {
      return {StopReason::interrupted, std::move(steps).views()};
    }
    double sensing_time = 0.0;
    scan = timed(sensing_time, [&] { return ports.sense(*next, std::move(scan)); });
    try {
      next = steps.take_in(scan, sensing_time);
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
