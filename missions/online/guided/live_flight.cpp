#include "missions/online/guided/live_flight.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;

/// Returns true if the vehicle's position is known, so that it can fly a verified path.
bool may_return(FailureKind kind) {
  switch (kind) {
    case FailureKind::pilot:
    case FailureKind::link:
    case FailureKind::position:
    case FailureKind::off_leg:
    case FailureKind::pose:
      return false;
    default:
      return true;
  }
}

}  // namespace

std::future<void> run_at_once(const std::function<void()>& work) {
  std::packaged_task<void()> task(work);
  task();
  return task.get_future();
}

LiveFlight::LiveFlight(LiveSurvey& survey, GuidedFlight& vehicle, const flight::Motion& motion,
                       Sensor sensor, FlightOptions options)
    : survey_(survey),
      vehicle_(vehicle),
      motion_(motion),
      pad_(survey.flight()->pad()),
      above_pad_(survey.flight()->above_pad()),
      sensor_(std::move(sensor)),
      options_(std::move(options)) {
  FlightObserver observer = options_.observer;
  observer.note = options_.note;
  vehicle_.observe(std::move(observer));
}

FlightEnd LiveFlight::run() {
  MaybeFailure failure = begin();
  while (!failure && survey_.proposal().view) failure = visit(*survey_.proposal().view);
  if (failure) return end(*failure);
  options_.note("survey completed");
  if (MaybeFailure held = vehicle_.hold_on_request()) return end(*held);
  return return_to_home(std::nullopt);
}

MaybeFailure LiveFlight::begin() {
  if (options_.observer.is_held()) {
    return rejected("the survey is held; resume it before the take-off");
  }
  const Vector3d spot = vehicle_.view().position;
  here_ = {spot.x(), spot.y(), above_pad_.z()};
  // The vehicle may stand off the centre of the pad and climbs vertically from its position.
  const double checked_top = std::min(pad_.z() + options_.checked_height, above_pad_.z());
  const auto climb = survey_.flight()->find_path({spot.x(), spot.y(), checked_top}, here_);
  const auto over = survey_.flight()->find_path(here_, above_pad_);
  if (!climb || climb->points.size() > 2 || !over) {
    return FlightFailure{FailureKind::rejected,
                         "the climb from the vehicle's position is not verified to be free"};
  }
  home_ = over->points;
  if (survey_.proposal().view) {
    search_path(*survey_.proposal().view);
    if (MaybeFailure failure = check_battery()) return failure;
  }
  options_.note(fmt::format("taking off to {:.1f} m", above_pad_.z() - pad_.z()));
  if (MaybeFailure failure = vehicle_.take_off(here_)) return failure;
  has_climbed_ = true;
  return std::nullopt;
}

MaybeFailure LiveFlight::visit(const geometry::View& view) {
  if (MaybeFailure failure = vehicle_.hold_on_request()) return failure;
  if (MaybeFailure failure = find_path(view)) return failure;
  if (MaybeFailure failure = check_battery()) return failure;
  options_.note(fmt::format("view {}: flying to ({:.1f}, {:.1f}, {:.1f})", survey_.views().size(),
                            view.position.x(), view.position.y(), view.position.z()));
  if (MaybeFailure failure = vehicle_.aim(view)) return failure;
  if (MaybeFailure failure = vehicle_.fly(path_)) return failure;
  here_ = path_.back();
  if (MaybeFailure failure = vehicle_.settle(view)) return failure;
  if (vehicle_.reports_against_vehicle() && !std::exchange(is_gimbal_noted_, true)) {
    options_.note(
        "the gimbal reports its pitch relative to the vehicle, not to the horizon: the vehicle's "
        "pitch is added");
  }
  if (MaybeFailure failure = sense(view)) return failure;
  return plan();
}

/// Uses the proposed path if it starts at the current position. Otherwise plans a path: a resumed
/// survey starts above the pad.
void LiveFlight::search_path(const geometry::View& view) {
  path_ = survey_.proposal().path.points;
  if (!path_.empty() && path_.front() == here_) return;
  const auto found = survey_.flight()->find_path(here_, view.position);
  path_ = found ? found->points : std::vector<Vector3d>();
}

MaybeFailure LiveFlight::find_path(const geometry::View& view) {
  if (MaybeFailure failure = run_async([this, view] { search_path(view); }, options_.planning_limit,
                                       FailureKind::planner, "planning a path to the view")) {
    return failure;
  }
  if (!path_.empty()) return std::nullopt;
  return FlightFailure{FailureKind::planner,
                       "no verified path from the vehicle's position to the view"};
}

/// Checks that the battery suffices for the path to the view, back, and the return from here.
MaybeFailure LiveFlight::check_battery() {
  const double there = share_for(path_);
  const double return_energy =
      there + share_for(home_) + share_for({above_pad_, pad_}) + motion_.conditions().reserve;
  const double left = vehicle_.battery().value_or(0.0);
  if (left < there + return_energy) {
    return FlightFailure{FailureKind::battery,
                         fmt::format("battery at {:.0f}%; the next view and the return from it, "
                                     "including the reserve, require {:.0f}%",
                                     100.0 * left, 100.0 * (there + return_energy))};
  }
  vehicle_.need_battery(return_energy);
  return std::nullopt;
}

double LiveFlight::share_for(const std::vector<Vector3d>& path) const {
  double energy = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vector3d leg = path[i] - path[i - 1];
    energy += motion_.leg_energy(leg, motion_.leg_time(leg));
  }
  // usable_energy() is the energy of full batteries above the reserve, with a margin for model
  // error.
  return energy / motion_.usable_energy() * (1.0 - motion_.conditions().reserve);
}

MaybeFailure LiveFlight::sense(const geometry::View& view) {
  const auto work = [this, view, actual_view = vehicle_.view()] {
    scan_ = sensor_(view, actual_view, survey_.views().size());
  };
  return run_async(work, options_.sensing_limit, FailureKind::sensor, "the scan");
}

MaybeFailure LiveFlight::plan() {
  const auto work = [this] {
    is_new_ = survey_.add(scan_, "");
    found_return_path_.reset();
    options_.show();
    if (!survey_.proposal().has_pose_warning()) {
      found_return_path_ = survey_.flight()->find_path(here_, above_pad_);
    }
  };
  if (MaybeFailure failure = run_async(work, options_.planning_limit, FailureKind::planner,
                                       "planning the next view")) {
    return failure;
  }
  if (!is_new_)
    return FlightFailure{FailureKind::sensor, "the sensor delivered the same scan twice"};
  if (survey_.proposal().has_pose_warning()) {
    return FlightFailure{
        FailureKind::pose,
        "scan rejected: pose inconsistent with the map at the vehicle's estimated position"};
  }
  // Otherwise the return uses the paths flown so far, which were verified before they were flown.
  home_ = found_return_path_ ? found_return_path_->points : return_path();
  vehicle_.clear_track();
  return std::nullopt;
}

MaybeFailure LiveFlight::run_async(std::function<void()> work, double limit, FailureKind kind,
                                   const std::string& what) {
  const auto worker_error = std::make_shared<std::string>();
  work_ = options_.launch([work = std::move(work), worker_error] {
    try {
      work();
    } catch (const Error& error) {
      *worker_error = error.what();
    }
  });
  const auto is_done = [this] {
    return work_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  };
  const FlightFailure too_late{kind,
                               fmt::format("timeout: {} took more than {:.0f} s", what, limit)};
  if (MaybeFailure failure = vehicle_.hold_until(is_done, limit, too_late)) return failure;
  work_.get();
  if (!worker_error->empty()) return FlightFailure{kind, what + " failed: " + *worker_error};
  return std::nullopt;
}

std::vector<Vector3d> LiveFlight::return_path() const {
  std::vector<Vector3d> path = vehicle_.reversed_track();
  if (!has_climbed_) return path;
  for (const Vector3d& position : home_) {
    if (path.back() != position) path.push_back(position);
  }
  return path;
}

FlightEnd LiveFlight::end(const FlightFailure& failure) {
  if (!vehicle_.is_flying()) return {failure, false};
  options_.note(failure.what);
  const bool is_needed = options_.returns_on_failure || failure.kind == FailureKind::battery;
  if (is_needed && may_return(failure.kind)) return return_to_home(failure);
  return hold(failure);
}

FlightEnd LiveFlight::hold(const FlightFailure& failure) {
  if (failure.kind != FailureKind::pilot) {
    options_.note("holding position until a pilot takes control");
    options_.note(vehicle_.hold_until_takeover().what);
  }
  return {failure, false};
}

FlightEnd LiveFlight::return_to_home(const MaybeFailure& failure) {
  options_.note("returning to the take-off point");
  vehicle_.begin_return();
  MaybeFailure return_failure = vehicle_.fly(return_path());
  if (!return_failure) return_failure = vehicle_.land(pad_);
  if (!return_failure) return {failure, true};
  options_.note(return_failure->what);
  return hold(failure ? *failure : *return_failure);
}

}  // namespace skycap::missions::online
