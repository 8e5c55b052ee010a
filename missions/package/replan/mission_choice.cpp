#include "missions/package/replan/mission_choice.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "flight/motion/motion.h"
#include "flight/route/leg_costs.h"
#include "flight/way_home/returnable_space.h"
#include "geometry/error.h"
#include "geometry/interrupted.h"
#include "geometry/parallel.h"
#include "geometry/place/platform.h"
#include "missions/package/replan/dose_sum.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using geometry::View;
using survey::skycap::GainField;
using survey::skycap::Look;

/// Margin of views in addition to the clearance, so that the legs from them can be verified [m].
constexpr double spare_clearance = 0.05;

/// Tolerance for equal coverage. Repeated simulated flights with the same views differ by several
/// times this value.
constexpr double equal_coverage = 5e-4;

/// Penalty per view in fly-through capture [s]. Without it, tours would have so many views that
/// moves of single views have no effect.
constexpr double price_of_passing = 0.3;

/// Ratio of computation times for a scanner's path (tens of scans of three views) and a view. The
/// number of moves is reduced by this factor.
constexpr std::size_t dearer_ways = 12;

/// Factor of the number of moves for fly-through tours, which have this many times more views than
/// the initial tour.
constexpr std::size_t more_passed_views = 2;

/// Returns the maximum height of a route.
double top_of(const flight::Route& route) {
  double top = route.options.takeoff.z() + route.options.takeoff_climb;
  for (const flight::Station& station : route.stations) {
    top = std::max(top, station.view.position.z());
  }
  return top;
}

/// Returns true for fly-through routes. Otherwise stops are faster, and views are selected for
/// stops.
bool is_passed(const flight::Route& route) {
  return std::ranges::any_of(
      route.sorties, [](const flight::Sortie& sortie) { return sortie.passage.has_value(); });
}

/// Tour problem of a mission and the data that it refers to.
class MissionProblem {
 public:
  MissionProblem(const flight::FlightOptions& flight, const survey::PlannerOptions& planner,
                 const ChoiceOptions& choice, const GainField& surface,
                 const flight::FreeSpace& space, const flight::Route& present)
      : surface_(surface),
        space_(space),
        vehicle_(present.vehicle),
        limits_(planner.limits),
        motion_(present.vehicle, present.options.conditions),
        clearance_(present.clearance),
        returnable_(space, planning_law(present.options, top_of(present))),
        costs_(motion_),
        passing_(is_passed(present) ? std::optional(present.options.passing) : std::nullopt),
        mount_(flight.capture.scans_in_flight() ? flight.capture.mount : std::nullopt),
        kind_(choice.scanner),
        sweep_step_(flight.cruise_speed * flight.capture.frame_period),
        threads_(choice.threads),
        home_(present.options.takeoff + Vector3d(0.0, 0.0, present.options.takeoff_climb)) {
    problem_.targets = surface.targets();
    problem_.home = home_;
    problem_.view_distance = planner.view_distance;
    if (passing_) {
      problem_.time_per_view = price_of_passing;
      problem_.bend_time = [this](const View* before, const View& at, const View* after) {
        return bend_time(at.position - place(before), place(after) - at.position);
      };
    } else {
      const flight::Station station{
          .view = {}, .hold = flight.rest_before(), .hold_after = flight.rest_after()};
      problem_.time_per_view = costs_.station_cost(station).time;
    }
    problem_.looks = [this](const View& view) {
      return mount_ ? std::vector<Look>() : surface_.looks(view);
    };
    if (mount_) {
      problem_.way_looks = [this](const View* from, const View* to) {
        return way_looks({place(from), place(to)}, from, to);
      };
    }
    problem_.view_of = [this](const Vector3d& target, const Vector3d& towards, double distance) {
      return limits_.view_of_target(target, towards, distance);
    };
    problem_.is_allowed = [this](const View& view) {
      return limits_.allow(view) && can_look(vehicle_, carrier(view));
    };
    problem_.is_in_free_space = [this](const View& view) {
      const double kept = std::max(clearance_, limits_.stand_off) + spare_clearance;
      return space_.is_free({view.position, view.position}, kept);
    };
    problem_.has_way_home = [this](const View& view) {
      return returnable_.has_returns({view.position, view.position}, clearance_);
    };
    problem_.straight_time = [this](const View* from, const View* to) {
      return straight_time(from, to);
    };
    problem_.is_free = [this](const View* from, const View* to) {
      return space_.is_free({place(from), place(to)}, clearance_);
    };
    problem_.has_returns = [this](const View* from, const View* to) {
      return returnable_.has_returns({place(from), place(to)}, clearance_);
    };
  }

  MissionProblem(const MissionProblem&) = delete;
  MissionProblem& operator=(const MissionProblem&) = delete;

  const TourProblem& problem() const { return problem_; }

  /// Returns the predicted coverage of a route: that of its views or, for scanners, of its flown
  /// paths.
  double promised(const flight::Route& route) const {
    if (!mount_) return covered_by(problem_, picture_views(route));
    const std::vector<View> views = views_of(route);
    DoseSum covered(problem_.targets);
    const auto add = [&](const flight::Leg& leg, const View* from, const View* to) {
      covered.add(doses_of(way_looks(leg.points, from, to)));
    };
    for (const flight::Sortie& sortie : route.sorties) {
      add(sortie.out, nullptr, &views[sortie.first]);
      for (std::uint32_t i = sortie.first; i < sortie.last; ++i) {
        add(route.legs[i], &views[i], &views[i + 1]);
      }
      add(sortie.back, &views[sortie.last], nullptr);
    }
    return covered.covered();
  }

  /// Converts stations to views. Stations of a scanner define the direction of the vehicle's nose.
  std::vector<View> views_of(const flight::Route& route) const {
    std::vector<View> views;
    for (const flight::Station& station : route.stations) {
      views.push_back(mount_ ? geometry::scanner_view(*mount_, station.view) : station.view);
    }
    return views;
  }

  /// Returns the stations and paths of a route as flown.
  StationPlan stations_of(const flight::Route& route) const {
    StationPlan plan{views_of(route), {}};
    plan.ways.resize(plan.views.size());
    for (std::size_t i = 1; i < plan.views.size(); ++i) plan.ways[i] = route.legs[i - 1].points;
    if (!route.sorties.empty()) plan.ways.front() = route.sorties.front().out.points;
    return plan;
  }

 private:
  const Vector3d& place(const View* view) const { return view == nullptr ? home_ : view->position; }

  double straight_time(const View* from, const View* to) const {
    if (passing_) return passing_time(from, to);
    const double leg = motion_.leg_time(place(to) - place(from));
    if (from == nullptr || to == nullptr) return leg;
    const flight::Station there{.view = carrier(*to)}, here{.view = carrier(*from)};
    return costs_.aimed_time(leg, &here, &there);
  }

  /// Returns the duration of a fly-through path [s]. Stops occur only above the pad, where half of
  /// the acceleration ramp is lost.
  double passing_time(const View* from, const View* to) const {
    const Vector3d way = place(to) - place(from);
    if (way.norm() == 0.0) return from == nullptr || to == nullptr ? 0.0 : turn_time(*from, *to);
    const Vector3d direction = way.normalized();
    const double flying = way.norm() / passing_speed(direction);
    if (from != nullptr && to != nullptr) return std::max(flying, turn_time(*from, *to));
    return flying + ramp_loss(direction);
  }

  double passing_speed(const Vector3d& direction) const {
    return std::min(motion_.leg_speed(direction), passing_->speed);
  }

  /// Returns the time lost by starting or ending a path at rest [s].
  double ramp_loss(const Vector3d& direction) const {
    const double acceleration = motion_.leg_acceleration(direction);
    return 0.5 *
           (passing_speed(direction) / acceleration + acceleration / motion_.vehicle().mode.jerk);
  }

  /// Returns the time lost in a bend [s]: zero for a straight path, that of a stop for a reversal.
  double bend_time(const Vector3d& before, const Vector3d& after) const {
    if (before.norm() == 0.0 || after.norm() == 0.0) return 0.0;
    const Vector3d in = before.normalized(), out = after.normalized();
    return 0.5 * (ramp_loss(in) + ramp_loss(out)) * (1.0 - in.dot(out));
  }

  double turn_time(const View& from, const View& to) const {
    const View here = carrier(from), there = carrier(to);
    return least_interval({flight::yaw_of(here), flight::pitch_of(here)},
                          {flight::yaw_of(there), flight::pitch_of(there)}, motion_, *passing_);
  }

  View carrier(const View& view) const {
    return mount_ ? geometry::nose_view(*mount_, view) : view;
  }

  /// Returns the viewing directions of a scanner for a direction of the nose. These are three
  /// quarters of the ring, because surfaces above are observed from above or not at all, or the
  /// field of view.
  std::vector<View> looks_of(const View& nose) const {
    const View view = geometry::scanner_view(*mount_, nose);
    if (kind_ == sim::ScannerKind::rosette) return {view};
    constexpr double almost = 1e-3;  // Avoids the undefined azimuth of the vertical direction.
    return {view,
            {view.position, -view.direction},
            {view.position, (almost * view.direction - Vector3d::UnitZ()).normalized()}};
  }

  /// Returns the observations of scans along a path at intervals of sweep_step_. The nose rotates
  /// on the last segment. At home, it points in the direction of the other end. Single-line LiDARs
  /// observe the area that they sweep at the view distance.
  std::vector<Look> way_looks(const std::vector<Vector3d>& points, const View* from,
                              const View* to) const {
    const View begin = carrier(from != nullptr ? *from : *to);
    const double yaw = flight::yaw_of(begin);
    const double turn = std::remainder(flight::yaw_of(carrier(to != nullptr ? *to : *from)) - yaw,
                                       2.0 * std::numbers::pi);
    std::vector<View> views;
    std::vector<float> shares;  // Relative hazard of the observations of each view.
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Vector3d way = points[i] - points[i - 1];
      const auto count = std::max(1L, std::lround(way.norm() / sweep_step_));
      for (long k = 0; k < count; ++k) {
        const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
        const double turned = i + 1 == points.size() ? turn : 0.0, at = yaw + share * turned;
        const View nose{points[i - 1] + share * way, {std::sin(at), std::cos(at), 0.0}};
        for (const View& view : looks_of(nose)) views.push_back(view);
        shares.resize(views.size(), kind_ == sim::ScannerKind::line
                                        ? swept_share(way, nose.direction, turned, count)
                                        : 1.0F);
      }
    }
    std::vector<std::vector<Look>> looks(views.size());
    geometry::parallel_for(views.size(), threads_,
                           [&](std::size_t i) { looks[i] = surface_.looks(views[i]); });
    std::vector<Look> all;
    for (std::size_t i = 0; i < looks.size(); ++i) {
      for (const Look& look : looks[i]) all.push_back({look.target, shares[i] * look.hazard});
    }
    return all;
  }

  /// Returns the length that each of `count` scans on a straight path sweeps, relative to
  /// sweep_step_. The length is measured at the view distance to the left while the nose rotates
  /// clockwise by `turn`.
  float swept_share(const Vector3d& way, const Vector3d& nose, double turn, long count) const {
    const double swept = way.dot(nose) + problem_.view_distance * turn;
    return static_cast<float>(std::abs(swept) / static_cast<double>(count) / sweep_step_);
  }

  const GainField& surface_;
  const flight::FreeSpace& space_;
  flight::Vehicle vehicle_;
  survey::ViewLimits limits_;
  flight::Motion motion_;
  double clearance_;
  flight::ReturnableSpace returnable_;
  flight::LegCosts costs_;
  std::optional<flight::PassRules> passing_;     ///< Set for fly-through capture.
  std::optional<geometry::ScannerMount> mount_;  ///< Set for scanners that measure continuously.
  sim::ScannerKind kind_;
  double sweep_step_;  ///< Distance between scans [m].
  unsigned threads_;
  Vector3d home_;
  TourProblem problem_;
};

/// Returns an empty value if planning the route fails. The previous route is then used.
std::optional<flight::Route> certified(const PlanRoute& plan, const std::vector<View>& views) {
  try {
    return plan({views, std::vector<std::vector<Vector3d>>(views.size())});
  } catch (const Interrupted&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

MissionFigures figures_of(const flight::Route& route, double promised) {
  MissionFigures figures{
      .duration = least_duration(route), .views = route.stations.size(), .promised = promised};
  for (const flight::Sortie& sortie : route.sorties) {
    if (const auto& passage = sortie.passage) {
      figures.length += passage->length + 2.0 * route.options.takeoff_climb;
      figures.pieces += passage->stops + 1;
    } else {
      figures.length += sortie.length;
      figures.pieces += sortie_points(route, sortie).size() - 1;
    }
  }
  return figures;
}

MissionChoice choose_mission(const flight::FlightOptions& flight,
                             const survey::PlannerOptions& planner, const ChoiceOptions& options,
                             const GainField& surface, const flight::FreeSpace& space,
                             const std::vector<View>& surveyed, flight::Route present,
                             const PlanRoute& plan, const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  const MissionProblem asked(flight, planner, options, surface, space, present);
  const TourProblem& problem = asked.problem();
  const std::vector<View> views = asked.views_of(present);
  MissionChoice choice;
  choice.survey = figures_of(present, asked.promised(present));
  choice.anew = choice.survey;
  choice.route = std::move(present);
  const double least = choice.survey.promised - equal_coverage;
  // The coverage of a scanner also depends on the paths that can be flown.
  const double wanted = problem.way_looks ? least : covered_by(problem, surveyed) - equal_coverage;
  const auto cost = [&](const MissionFigures& figures) {
    return figures.duration +
           100.0 * options.search.price * std::max(0.0, wanted - figures.promised);
  };

  const auto try_tour = [&](const FoundTour& tour) {
    if (stop.stop_requested()) return;
    std::optional<flight::Route> route = certified(plan, tour.views);
    if (!route) return;
    const MissionFigures figures = figures_of(*route, asked.promised(*route));
    if (figures.promised < least || cost(figures) >= cost(choice.anew)) return;
    choice.anew = figures;
    choice.route = *std::move(route);
    choice.is_anew = true;
  };
  const FoundTour spared = spare_views(problem, views, least);
  if (spared.views.size() < views.size()) try_tour(spared);
  SearchSettings search = options.search;
  if (problem.way_looks) search.moves_per_view /= dearer_ways;
  if (problem.bend_time) search.moves_per_view *= more_passed_views;
  try_tour(anneal(problem, spared.views, wanted, search, stop));

  choice.stations = asked.stations_of(choice.route);
  choice.computing =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return choice;
}

}  // namespace skycap::missions::package
