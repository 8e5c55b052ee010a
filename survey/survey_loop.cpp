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

/// The limit that one more view would break, after so many and with all ways this long.
std::optional<StopReason> broken_limit(const SurveyLimits& limits, std::size_t views,
                                       double distance) {
  if (views >= limits.max_views) return StopReason::view_limit;
  if (limits.max_distance && distance > *limits.max_distance) return StopReason::distance_limit;
  const double time =
      distance / limits.speed + static_cast<double>(views + 1) * limits.time_per_view;
  if (limits.max_time && time > *limits.max_time) return StopReason::time_limit;
  return std::nullopt;
}

}  // namespace

SurveyResult run_survey(Planner& planner, const View& first_view, const SurveyLimits& limits,
                        const SurveyPorts& ports, std::stop_token stop) {
  SurveyResult result;
  std::optional<View> next = first_view;
  double distance = 0.0;
  geometry::Scan scan;
  while (true) {
    SurveyedView taken;
    scan = timed(taken.sensing_time, [&] { return ports.sense(*next, std::move(scan)); });
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
    std::optional<StopReason> reason = broken_limit(limits, result.views.size(), distance + way);
    if (!reason && stop.stop_requested()) reason = StopReason::interrupted;
    if (!reason) continue;
    result.stop_reason = *reason;
    return result;
  }
}

}  // namespace skycap::survey
