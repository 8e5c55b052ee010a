#include "flight/export/photo_runs.h"

#include <algorithm>
#include <cmath>

#include "flight/motion/motion.h"
#include "geometry/angle.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Maximum angle between a photo's direction and that of the first photo in its run [rad].
constexpr double same_aim = 0.5 * geometry::radians_per_degree;

/// Maximum distance of a photo from its run's leg, whose clearance is verified [m].
constexpr double same_line = 0.02;

/// Minimum speed of a run [m/s]. Formats store speeds with two decimals.
constexpr double speed_step = 0.01, min_run_speed = 0.3;

/// Finds the runs of a plan sequentially.
class RunFinder {
 public:
  explicit RunFinder(const FlightPlan& plan) : plan_(plan), times_(stop_times(plan)) {}

  /// Longest run from a waypoint, and the index of its last waypoint. The run has no photos if none
  /// is possible.
  struct Found {
    std::size_t last = 0;
    PhotoRun run;
  };
  Found longest_from(std::size_t first) const {
    Found found;
    if (!is_photo(plan_.waypoints[first])) return found;
    for (std::size_t last = first + 1; last < plan_.waypoints.size(); ++last) {
      if (!is_photo(plan_.waypoints[last]) || !has_same_aim(first, last)) break;
      const Vector3d path_curve = position(last) - position(first);
      if (is_beside(first, last, path_curve)) break;
      if (last == first + 1) continue;  // No photo is between them.
      const auto run = make_run(first, last, path_curve);
      if (run) found = {last, *run};
    }
    return found;
  }

 private:
  const Vector3d& position(std::size_t i) const { return plan_.waypoints[i].position; }

  static bool is_photo(const Waypoint& waypoint) {
    return waypoint.is_capture_point && waypoint.captures == 1 && waypoint.path_curve() == nullptr;
  }

  bool has_same_aim(std::size_t first, std::size_t other) const {
    const Waypoint &a = plan_.waypoints[first], &b = plan_.waypoints[other];
    const Vector3d from = compute_direction({a.yaw, a.pitch}),
                   to = compute_direction({b.yaw, b.pitch});
    return std::atan2(from.cross(to).norm(), from.dot(to)) <= same_aim;
  }

  /// Returns true if a point between them is off their line or out of order.
  bool is_beside(std::size_t first, std::size_t last, const Vector3d& path_curve) const {
    const double length = path_curve.norm();
    if (length == 0.0) return true;
    double along = 0.0;
    for (std::size_t i = first + 1; i <= last; ++i) {
      const Vector3d offset = position(i) - position(first);
      const double here = offset.dot(path_curve) / length;
      if (here <= along || (offset - here / length * path_curve).norm() > same_line) return true;
      along = here;
    }
    return false;
  }

  std::optional<PhotoRun> make_run(std::size_t first, std::size_t last,
                                   const Vector3d& path_curve) const {
    const double length = path_curve.norm();
    PhotoRun run{.spacing = length / static_cast<double>(last - first)};
    for (std::size_t i = first + 1; i < last; ++i) {
      const double planned = (position(i) - position(first)).dot(path_curve) / length;
      const double taken = static_cast<double>(i - first) * run.spacing;
      if (std::abs(planned - taken) > run_evenness * run.spacing) return std::nullopt;
    }
    const double limit =
        photo_speeds(*plan_.photo, run.spacing, plan_.conditions.cruise_speed).min();
    run.speed = std::floor(limit / speed_step + 1e-9) * speed_step;
    if (run.speed < min_run_speed) return std::nullopt;
    const double with_stops = times_[last].arrival - times_[first].departure;
    if (run_time(plan_, run, path_curve) >= with_stops) return std::nullopt;
    return run;
  }

  const FlightPlan& plan_;
  std::vector<StopTime> times_;
};

}  // namespace

FlightPlan with_photo_runs(FlightPlan plan) {
  if (!plan.photo || !plan.passed.empty()) return plan;
  const RunFinder finder(plan);
  std::vector<Waypoint> waypoints, passed;
  for (std::size_t i = 0; i < plan.waypoints.size();) {
    waypoints.push_back(plan.waypoints[i]);
    RunFinder::Found found = finder.longest_from(i);
    if (found.last == 0) {
      ++i;
      continue;
    }
    found.run.first = static_cast<std::uint32_t>(passed.size());
    found.run.count = static_cast<std::uint32_t>(found.last - i - 1);
    for (std::size_t k = i + 1; k < found.last; ++k) {
      passed.push_back(plan.waypoints[k]);
      passed.back().hold = passed.back().hold_after = 0.0;
    }
    // The end may be the start of the next run and is therefore processed again.
    plan.waypoints[found.last].run = found.run;
    i = found.last;
  }
  plan.waypoints = std::move(waypoints);
  plan.passed = std::move(passed);
  return plan;
}

std::size_t photos_in_runs(const FlightPlan& plan) {
  std::size_t photos = 0;
  for (const Waypoint& waypoint : plan.waypoints) {
    if (waypoint.run) photos += waypoint.run->count;
  }
  return photos;
}

}  // namespace skycap::flight
