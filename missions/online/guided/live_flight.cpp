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
bool may_return(TroubleKind kind) {
  switch (kind) {
    case TroubleKind::pilot:
    case TroubleKind::link:
    case TroubleKind::position:
    case TroubleKind::off_leg:
    case TroubleKind::pose:
      return false;
    default:
      return true;
  }
}

}  // namespace

LiveFlight::LiveFlight(LiveSurvey& survey, GuidedFlight& vehicle, const flight::Motion& motion,
                       Sensor sensor, FlightOptions options)
    : survey_(survey),
      vehicle_(vehicle),
      motion_(motion),
      pad_(survey.flight()->pad()),
      above_pad_(survey.flight()->above_pad()),
      sensor_(std::move(sensor)),
      options_(std::move(options)) {}

FlightEnd LiveFlight::run() {
  MaybeTrouble trouble = begin();
  while (!trouble && survey_.proposal().view) trouble = visit(*survey_.proposal().view);
  if (trouble) return end(*trouble);
  options_.note("survey completed");
  return go_home(std::nullopt);
}

MaybeTrouble LiveFlight::begin() {
  const Vector3d spot = vehicle_.view().position;
  here_ = {spot.x(), spot.y(), above_pad_.z()};
  // The vehicle may stand off the centre of the pad and climbs vertically from its position.
  const double vouched = std::min(pad_.z() + options_.vouched, above_pad_.z());
  const auto climb = survey_.flight()->find_way({spot.x(), spot.y(), vouched}, here_);
  const auto over = survey_.flight()->find_way(here_, above_pad_);
  if (!climb || climb->points.size() > 2 || !over) {
    return Trouble{TroubleKind::refused,
                   "the climb from the vehicle's position is not verified as free"};
  }
  home_ = over->points;
  if (survey_.proposal().view) {
    search_way(*survey_.proposal().view);
    if (MaybeTrouble trouble = check_battery()) return trouble;
  }
  options_.note(fmt::format("taking off to {:.1f} m", above_pad_.z() - pad_.z()));
  if (MaybeTrouble trouble = vehicle_.take_off(here_)) return trouble;
  has_climbed_ = true;
  return std::nullopt;
}

MaybeTrouble LiveFlight::visit(const geometry::View& view) {
  if (MaybeTrouble trouble = find_way(view)) return trouble;
  if (MaybeTrouble trouble = check_battery()) return trouble;
  options_.note(fmt::format("view {}: flying to ({:.1f}, {:.1f}, {:.1f})", survey_.views().size(),
                            view.position.x(), view.position.y(), view.position.z()));
  if (MaybeTrouble trouble = vehicle_.aim(view)) return trouble;
  if (MaybeTrouble trouble = vehicle_.fly(way_)) return trouble;
  here_ = way_.back();
  if (MaybeTrouble trouble = vehicle_.settle(view)) return trouble;
  if (vehicle_.reports_against_vehicle() && !std::exchange(is_gimbal_noted_, true)) {
    options_.note(
        "the gimbal reports its pitch relative to the vehicle, not to the horizon: the vehicle's "
        "pitch is added");
  }
  if (MaybeTrouble trouble = sense(view)) return trouble;
  return plan();
}

/// Uses the proposed path if it starts at the current position. Otherwise plans a path: a resumed
/// survey starts above the pad.
void LiveFlight::search_way(const geometry::View& view) {
  way_ = survey_.proposal().way.points;
  if (!way_.empty() && way_.front() == here_) return;
  const auto found = survey_.flight()->find_way(here_, view.position);
  way_ = found ? found->points : std::vector<Vector3d>();
}

MaybeTrouble LiveFlight::find_way(const geometry::View& view) {
  if (MaybeTrouble trouble = beside([this, view] { search_way(view); }, options_.planning_limit,
                                    TroubleKind::planner, "planning a path to the view")) {
    return trouble;
  }
  if (!way_.empty()) return std::nullopt;
  return Trouble{TroubleKind::planner, "no verified path from the vehicle's position to the view"};
}

/// Checks that the battery suffices for the path to the view, back, and the return from here.
MaybeTrouble LiveFlight::check_battery() {
  const double there = share_for(way_);
  const double home =
      there + share_for(home_) + share_for({above_pad_, pad_}) + motion_.conditions().reserve;
  const double left = vehicle_.battery().value_or(0.0);
  if (left < there + home) {
    return Trouble{
        TroubleKind::battery,
        fmt::format(
            "battery at {:.0f}%; the next view and the return from it, with reserve, need {:.0f}%",
            100.0 * left, 100.0 * (there + home))};
  }
  vehicle_.need_battery(home);
  return std::nullopt;
}

double LiveFlight::share_for(const std::vector<Vector3d>& way) const {
  double energy = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Vector3d leg = way[i] - way[i - 1];
    energy += motion_.leg_energy(leg, motion_.leg_time(leg));
  }
  // usable_energy() is the energy of full batteries above the reserve, with a margin for model
  // error.
  return energy / motion_.usable_energy() * (1.0 - motion_.conditions().reserve);
}

MaybeTrouble LiveFlight::sense(const geometry::View& view) {
  const auto work = [this, view, taken = vehicle_.view()] {
    scan_ = sensor_(view, taken, survey_.views().size());
  };
  return beside(work, options_.sensing_limit, TroubleKind::sensor, "the scan");
}

MaybeTrouble LiveFlight::plan() {
  const auto work = [this] {
    is_new_ = survey_.add(scan_, "");
    home_found_.reset();
    options_.show();
    if (!survey_.proposal().warns_of_pose()) {
      home_found_ = survey_.flight()->find_way(here_, above_pad_);
    }
  };
  if (MaybeTrouble trouble =
          beside(work, options_.planning_limit, TroubleKind::planner, "planning the next view")) {
    return trouble;
  }
  if (!is_new_) return Trouble{TroubleKind::sensor, "the sensor delivered the same scan twice"};
  if (survey_.proposal().warns_of_pose()) {
    return Trouble{
        TroubleKind::pose,
        "scan rejected: pose inconsistent with the map at the vehicle's estimated position"};
  }
  // Otherwise the return uses the paths flown so far, which were verified before they were flown.
  home_ = home_found_ ? home_found_->points : way_home();
  vehicle_.forget_way();
  return std::nullopt;
}

MaybeTrouble LiveFlight::beside(std::function<void()> work, double limit, TroubleKind kind,
                                const std::string& what) {
  const auto failure = std::make_shared<std::string>();
  work_ = options_.launch([work = std::move(work), failure] {
    try {
      work();
    } catch (const Error& error) {
      *failure = error.what();
    }
  });
  const auto is_done = [this] {
    return work_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  };
  const Trouble too_late{kind, fmt::format("timeout: {} took more than {:.0f} s", what, limit)};
  if (MaybeTrouble trouble = vehicle_.hold_until(is_done, limit, too_late)) return trouble;
  work_.get();
  if (!failure->empty()) return Trouble{kind, what + " failed: " + *failure};
  return std::nullopt;
}

std::vector<Vector3d> LiveFlight::way_home() const {
  std::vector<Vector3d> way = vehicle_.way_back();
  if (!has_climbed_) return way;
  for (const Vector3d& place : home_) {
    if (way.back() != place) way.push_back(place);
  }
  return way;
}

FlightEnd LiveFlight::end(const Trouble& trouble) {
  if (!vehicle_.is_flying()) return {trouble, false};
  options_.note(trouble.what);
  const bool is_needed = options_.returns_on_failure || trouble.kind == TroubleKind::battery;
  if (is_needed && may_return(trouble.kind)) return go_home(trouble);
  return hold(trouble);
}

FlightEnd LiveFlight::hold(const Trouble& trouble) {
  if (trouble.kind != TroubleKind::pilot) {
    options_.note("holding position until a pilot takes control");
    options_.note(vehicle_.hold_on().what);
  }
  return {trouble, false};
}

FlightEnd LiveFlight::go_home(const MaybeTrouble& trouble) {
  options_.note("returning to the take-off point");
  vehicle_.begin_return();
  MaybeTrouble on_the_way = vehicle_.fly(way_home());
  if (!on_the_way) on_the_way = vehicle_.land(pad_);
  if (!on_the_way) return {trouble, true};
  options_.note(on_the_way->what);
  return hold(trouble ? *trouble : *on_the_way);
}

}  // namespace skycap::missions::online
