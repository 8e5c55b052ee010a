#include "missions/package/replan/mission_choice.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "flight/export/text.h"
#include "flight/motion/motion.h"
#include "flight/route/curved_flight.h"
#include "flight/route/leg_costs.h"
#include "flight/rtl/returnable_space.h"
#include "geometry/error.h"
#include "geometry/interrupted.h"
#include "geometry/parallel.h"
#include "geometry/pose/platform.h"
#include "missions/package/replan/observation_sum.h"
#include "missions/session/en_route_frames.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using geometry::View;
using survey::surfel::GainField;
using survey::surfel::Observation;

/// Margin of views in addition to the clearance, so that the legs from them can be verified [m].
constexpr double clearance_margin = 0.05;

/// Tolerance for equal coverage. Repeated simulated flights with the same views differ by several
/// times this value.
constexpr double equal_coverage = 5e-4;

/// Tolerance for equal coverage in predicted re-flights.
constexpr double equal_reflight = 3e-3;

/// Additional coverage that the search aims at if re-flights are compared. The search selects the
/// views whose coverage it overestimates.
constexpr double reflight_margin = 6e-3;

/// Number of measured points that the search covers if re-flights are compared. With half as many,
/// it selects views for these points instead of the surface.
constexpr std::size_t point_targets = 12'000;

/// Maximum number of measured points whose coverage is compared.
constexpr std::size_t compared_points = 100'000;

/// Factor by which a search that covers measured points has fewer moves, because they take longer.
constexpr std::size_t point_cost_factor = 4;
/// Number of moves of such a search if it has few views.
constexpr std::size_t moves_of_few_views = 6'000;

/// Penalty per view in fly-through capture [s]. Without it, tours would have so many views that
/// moves of single views have no effect.
constexpr double fly_through_price = 0.3;

/// Ratio of computation times for a scanner's path (tens of scans of three views) and a view. The
/// number of moves is reduced by this factor.
constexpr std::size_t leg_cost_factor = 12;

/// Factor of the number of moves for fly-through tours, which have this many times more views than
/// the initial tour.
constexpr std::size_t more_passed_views = 2;

/// Returns the maximum height of a route.
double compute_max_altitude(const flight::Route& route) {
  double top = route.options.takeoff.z() + route.options.takeoff_climb;
  for (const flight::CapturePoint& capture_point : route.capture_points) {
    top = std::max(top, capture_point.view.position.z());
  }
  return top;
}

/// Returns true for fly-through routes. Otherwise stops are faster, and views are selected for
/// stops.
bool is_passed(const flight::Route& route) {
  return std::ranges::any_of(
      route.sorties, [](const flight::Sortie& sortie) { return sortie.fly_through.has_value(); });
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
        returnable_(space, planning_rtl_profile(present.options, compute_max_altitude(present))),
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
      problem_.time_per_view = fly_through_price;
      problem_.bend_time = [this](const View* before, const View& at, const View* after) {
        return bend_time(at.position - view_position(before), view_position(after) - at.position);
      };
    } else {
      const flight::CapturePoint capture_point{
          .view = {}, .hold = flight.rest_before(), .hold_after = flight.rest_after()};
      problem_.time_per_view = costs_.capture_cost(capture_point).time;
    }
    problem_.observations = [this](const View& view) {
      return mount_ ? std::vector<Observation>() : surface_.observations(view);
    };
    if (choice.measured != nullptr && !mount_) {
      problem_.remove_occluded = [this, measured = choice.measured](
                                     const View& view, std::vector<Observation>& observations) {
        remove_occluded(*measured, view, observations);
      };
    }
    if (mount_) {
      problem_.leg_observations = [this](const View* from, const View* to) {
        return leg_observations({view_position(from), view_position(to)}, from, to);
      };
    }
    problem_.find_view = [this](const Vector3d& target, const Vector3d& towards, double distance) {
      return limits_.make_target_view(target, towards, distance);
    };
    problem_.is_allowed = [this](const View& view) {
      return limits_.allow(view) && can_aim(vehicle_, platform(view));
    };
    problem_.is_in_free_space = [this](const View& view) {
      const double kept = std::max(clearance_, limits_.min_standoff) + clearance_margin;
      return space_.is_free({view.position, view.position}, kept);
    };
    problem_.has_return_path = [this](const View& view) {
      return returnable_.has_returns({view.position, view.position}, clearance_);
    };
    problem_.straight_time = [this](const View* from, const View* to) {
      return straight_time(from, to);
    };
    problem_.is_free = [this](const View* from, const View* to) {
      return space_.is_free({view_position(from), view_position(to)}, clearance_);
    };
    problem_.has_returns = [this](const View* from, const View* to) {
      return returnable_.has_returns({view_position(from), view_position(to)}, clearance_);
    };
  }

  MissionProblem(const MissionProblem&) = delete;
  MissionProblem& operator=(const MissionProblem&) = delete;

  const TourProblem& problem() const { return problem_; }

  /// Returns the predicted coverage of a route: that of its views or, for scanners, of its flown
  /// paths.
  double predicted_coverage(const flight::Route& route) const {
    if (!mount_) return covered_by(problem_, photo_views(route));
    const std::vector<View> views = collect_views(route);
    ObservationSum covered(problem_.targets);
    const auto add = [&](const flight::Leg& leg, const View* from, const View* to) {
      covered.add(observation_strengths(leg_observations(leg.points, from, to)));
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
  std::vector<View> collect_views(const flight::Route& route) const {
    std::vector<View> views;
    for (const flight::CapturePoint& capture_point : route.capture_points) {
      views.push_back(mount_ ? geometry::scanner_view(*mount_, capture_point.view)
                             : capture_point.view);
    }
    return views;
  }

  /// Returns the stations and paths of a route as flown.
  CapturePlan capture_plan(const flight::Route& route) const {
    CapturePlan plan{collect_views(route), {}};
    plan.paths.resize(plan.views.size());
    for (std::size_t i = 1; i < plan.views.size(); ++i) plan.paths[i] = route.legs[i - 1].points;
    if (!route.sorties.empty()) plan.paths.front() = route.sorties.front().out.points;
    return plan;
  }

  /// Returns the duration of the route's stations as a fly-through [s], if it is faster.
  std::optional<double> fly_through_duration(const flight::FlightOptions& flight,
                                             flight::Route route) const {
    if (flight.style != flight::FlightStyle::stop || mount_ || flight.capture.settle > 0.0 ||
        flight.is_fleet()) {
      return std::nullopt;
    }
    flight::FlightOptions passing = flight;
    passing.style = flight::FlightStyle::pass;
    route.options.style = passing.style;
    route.options.passing = passing.route(route.options.takeoff).passing;
    const double duration = flight::min_duration(route);
    flight::add_curves(route, space_, motion_, costs_);
    const double faster = flight::min_duration(route);
    return faster < duration ? std::optional(faster) : std::nullopt;
  }

 private:
  void remove_occluded(const MeasuredSurface& measured, const View& view,
                       std::vector<Observation>& observations) const {
    std::vector<Eigen::Vector3f> targets;
    targets.reserve(observations.size());
    for (const Observation& observation : observations) {
      targets.push_back(surface_.targets()[observation.target].position);
    }
    const std::vector<std::uint8_t> in_sight = measured.in_sight(view.position, targets);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < observations.size(); ++i) {
      if (in_sight[i] != 0) observations[kept++] = observations[i];
    }
    observations.resize(kept);
  }

  const Vector3d& view_position(const View* view) const {
    return view == nullptr ? home_ : view->position;
  }

  double straight_time(const View* from, const View* to) const {
    if (passing_) return passing_time(from, to);
    const double leg = motion_.leg_time(view_position(to) - view_position(from));
    if (from == nullptr || to == nullptr) return leg;
    const flight::CapturePoint there{.view = platform(*to)}, here{.view = platform(*from)};
    return costs_.aimed_time(leg, &here, &there);
  }

  /// Returns the duration of a fly-through path [s]. Stops occur only above the pad, where half of
  /// the acceleration ramp is lost.
  double passing_time(const View* from, const View* to) const {
    const Vector3d displacement = view_position(to) - view_position(from);
    if (displacement.norm() == 0.0)
      return from == nullptr || to == nullptr ? 0.0 : turn_time(*from, *to);
    const Vector3d direction = displacement.normalized();
    const double flying = displacement.norm() / passing_speed(direction);
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
    const View here = platform(from), there = platform(to);
    return min_interval({flight::compute_yaw(here), flight::compute_pitch(here)},
                        {flight::compute_yaw(there), flight::compute_pitch(there)}, motion_,
                        *passing_);
  }

  View platform(const View& view) const {
    return mount_ ? geometry::nose_view(*mount_, view) : view;
  }

  /// Returns the viewing directions of a scanner for a direction of the nose. These are three
  /// quarters of the ring, because surfaces above are observed from above or not at all, or the
  /// field of view.
  std::vector<View> scanner_views(const View& nose) const {
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
  std::vector<Observation> leg_observations(const std::vector<Vector3d>& points, const View* from,
                                            const View* to) const {
    const View begin = platform(from != nullptr ? *from : *to);
    const double yaw = flight::compute_yaw(begin);
    const double turn = std::remainder(
        flight::compute_yaw(platform(to != nullptr ? *to : *from)) - yaw, 2.0 * std::numbers::pi);
    std::vector<View> views;
    std::vector<float> shares;  // Relative hazard of the observations of each view.
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Vector3d displacement = points[i] - points[i - 1];
      const auto count = std::max(1L, std::lround(displacement.norm() / sweep_step_));
      for (long k = 0; k < count; ++k) {
        const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
        const double turned = i + 1 == points.size() ? turn : 0.0, at = yaw + share * turned;
        const View nose{points[i - 1] + share * displacement, {std::sin(at), std::cos(at), 0.0}};
        for (const View& view : scanner_views(nose)) views.push_back(view);
        shares.resize(views.size(), kind_ == sim::ScannerKind::line
                                        ? swept_share(displacement, nose.direction, turned, count)
                                        : 1.0F);
      }
    }
    std::vector<std::vector<Observation>> observations(views.size());
    geometry::parallel_for(views.size(), threads_, [&](std::size_t i) {
      observations[i] = surface_.observations(views[i]);
    });
    std::vector<Observation> all;
    for (std::size_t i = 0; i < observations.size(); ++i) {
      for (const Observation& observation : observations[i])
        all.push_back({observation.target, shares[i] * observation.hazard});
    }
    return all;
  }

  /// Returns the length that each of `count` scans on a straight path sweeps, relative to
  /// sweep_step_. The length is measured at the view distance to the left while the nose rotates
  /// clockwise by `turn`.
  float swept_share(const Vector3d& displacement, const Vector3d& nose, double turn,
                    long count) const {
    const double swept = displacement.dot(nose) + problem_.view_distance * turn;
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

/// Returns an empty value if planning the route fails, and the reason. The previous route is then
/// used.
std::optional<flight::Route> verified_route(const PlanRoute& plan, const std::vector<View>& views,
                                            std::string& reason) {
  try {
    return plan({views, std::vector<std::vector<Vector3d>>(views.size())});
  } catch (const Interrupted&) {
    return std::nullopt;
  } catch (const Error& error) {
    reason = std::string("the route through the replanned views is not verified: ") + error.what();
    return std::nullopt;
  }
}

std::string share_text(double share) { return flight::fixed(100.0 * share, 1) + "%"; }

}  // namespace

MissionFigures compute_figures(const flight::Route& route, double predicted_coverage) {
  MissionFigures figures{.duration = min_duration(route),
                         .views = route.capture_points.size(),
                         .predicted_coverage = predicted_coverage};
  for (const flight::Sortie& sortie : route.sorties) {
    if (const auto& fly_through = sortie.fly_through) {
      figures.length += fly_through->length + 2.0 * route.options.takeoff_climb;
      figures.segments += fly_through->stops + 1;
    } else {
      figures.length += sortie.length;
      figures.segments += sortie_points(route, sortie).size() - 1;
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
  std::optional<GainField> points;
  if (options.keeps_reflight) {
    points = surface.with_targets(options.measured->targets(point_targets));
  }
  std::optional<GainField> all_points;
  std::optional<MissionProblem> compared;
  if (options.measured != nullptr) {
    all_points = surface.with_targets(options.measured->targets(compared_points));
    compared.emplace(flight, planner, options, *all_points, space, present);
  }
  const MissionProblem asked(flight, planner, options, points ? *points : surface, space, present);
  const TourProblem& problem = asked.problem();
  const std::vector<View> views = asked.collect_views(present);
  const auto predicted_reflight = [&](const flight::Route& route) -> std::optional<double> {
    return compared ? std::optional(compared->predicted_coverage(route)) : std::nullopt;
  };
  MissionChoice choice;
  choice.survey = compute_figures(present, asked.predicted_coverage(present));
  choice.survey.predicted_reflight = predicted_reflight(present);
  choice.replanned = choice.survey;
  choice.reason = "no verified route through replanned views is faster";
  flight::Route best = present;
  const double min = choice.survey.predicted_coverage - equal_coverage;
  // The coverage of a scanner also depends on the paths that can be flown.
  const double target_coverage =
      problem.leg_observations ? min : covered_by(problem, surveyed) - equal_coverage;
  const auto cost = [&](const MissionFigures& figures) {
    return figures.duration + 100.0 * options.search.price *
                                  std::max(0.0, target_coverage - figures.predicted_coverage);
  };

  const auto try_tour = [&](const FoundTour& tour) {
    if (stop.stop_requested()) return;
    std::string failure;
    std::optional<flight::Route> route = verified_route(plan, tour.views, failure);
    if (!route && !failure.empty() && !choice.is_replanned) choice.reason = failure;
    if (!route) return;
    MissionFigures figures = compute_figures(*route, asked.predicted_coverage(*route));
    const MissionFigures& to_beat = choice.is_replanned ? choice.replanned : choice.survey;
    if (figures.predicted_coverage < min || cost(figures) >= cost(to_beat)) return;
    figures.predicted_reflight = predicted_reflight(*route);
    if (options.keeps_reflight &&
        *figures.predicted_reflight < *choice.survey.predicted_reflight - equal_reflight) {
      if (choice.is_replanned) return;
      choice.reason = "a re-flight with the replanned views would measure " +
                      share_text(*figures.predicted_reflight) +
                      " of the measured points, with those "
                      "of the survey " +
                      share_text(*choice.survey.predicted_reflight);
      choice.replanned = figures;
      return;
    }
    choice.replanned = figures;
    best = *std::move(route);
    choice.is_replanned = true;
    choice.reason = "fastest verified mission that keeps the coverage of the survey's views";
  };
  const FoundTour spared = remove_views(problem, views, min);
  if (spared.views.size() < views.size()) try_tour(spared);
  SearchSettings search = options.search;
  if (problem.leg_observations) search.moves_per_view /= leg_cost_factor;
  if (problem.bend_time) search.moves_per_view *= more_passed_views;
  if (options.keeps_reflight) {
    const std::size_t count = std::max<std::size_t>(1, spared.views.size());
    search.moves_per_view =
        std::clamp(moves_of_few_views / count, search.moves_per_view / point_cost_factor,
                   search.moves_per_view);
  }
  const double margin = options.keeps_reflight ? reflight_margin : 0.0;
  try_tour(anneal(problem, spared.views, target_coverage + margin, search, stop));

  if (stop.stop_requested()) {
    choice.is_replanned = false;
    choice.replanned = choice.survey;
    choice.reason = "interrupted";
  }
  choice.route = choice.is_replanned ? std::move(best) : std::move(present);
  if (!stop.stop_requested()) {
    choice.fly_through_duration = asked.fly_through_duration(flight, choice.route);
  }
  choice.capture_points = asked.capture_plan(choice.route);
  choice.computing =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return choice;
}

}  // namespace skycap::missions::package
