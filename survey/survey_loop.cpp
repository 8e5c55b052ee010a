#include "survey/survey_loop.h"

#include <chrono>
#include <ctime>
#include <optional>

namespace skycap::survey {
namespace {

using geometry::View;

/// Runs `work` and adds the seconds it took to `elapsed`.
template <typename Work>
auto timed(double& elapsed, Work work) {
  const auto start = std::chrono::steady_clock::now();
  auto result = work();
  elapsed += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

/// [s] that this thread kept a processor busy.
double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

SurveyResult run_survey(Planner& planner, const View& first_view, const SurveyLimits& limits,
                        const SurveyPorts& ports, std::stop_token stop) {
  SurveyResult result;
  std::optional<View> next = first_view;
  double distance = 0.0;
  while (true) {
    SurveyedView taken;
    const geometry::Scan scan = timed(taken.sensing_time, [&] { return ports.sense(*next); });
    if (ports.sensed) ports.sensed(scan);
    taken.view = geometry::view_of(scan.world_from_sensor);
    if (!result.views.empty()) {
      distance += (taken.view.position - result.views.back().view.position).norm();
    }
    const auto plan = [&](auto work) {
      const double begun = processor_time();
      next = timed(taken.planning_time, work);
      taken.planning_processor_time += processor_time() - begun;
    };
    plan([&] { return planner.next_view(scan); });
    bool refused = false;
    while (next && ports.can_reach && !ports.can_reach(taken.view.position, *next)) {
      refused = true;
      plan([&] { return planner.next_view_instead(); });
    }

    taken.distance = distance;
    taken.points = planner.cloud().size();
    taken.returns = scan.points.size();
    taken.step = planner.last_step();
    result.views.push_back(std::move(taken));
    if (ports.report) ports.report(result.views.back(), scan);

    if (!next) {
      result.stop_reason = refused ? StopReason::nowhere_to_go : StopReason::complete;
      return result;
    }
    const double way = (next->position - result.views.back().view.position).norm();
    if (result.views.size() >= limits.max_views) {
      result.stop_reason = StopReason::view_limit;
    } else if (distance + way > limits.max_distance) {
      result.stop_reason = StopReason::distance_limit;
    } else if ((distance + way) / limits.speed +
                   static_cast<double>(result.views.size() + 1) * limits.time_per_view >
               limits.max_time) {
      result.stop_reason = StopReason::time_limit;
    } else if (stop.stop_requested()) {
      result.stop_reason = StopReason::interrupted;
    } else {
      continue;
    }
    return result;
  }
}

}  // namespace skycap::survey
