#include "missions/anew/mission_choice.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "flight/motion/motion.h"
#include "flight/route/leg_certifier.h"
#include "flight/way_home/returnable_space.h"
#include "geometry/error.h"
#include "missions/derived/mission_flight.h"
#include "missions/derived/site.h"

namespace skycap::missions::anew {
namespace {

using Eigen::Vector3d;
using geometry::View;
using survey::skycap::GainField;

/// Views keep this much more than the clearance: room to prove the legs from there.
constexpr double spare_clearance = 0.05;

/// Covered shares that differ by less are the same: what the same views cover when they are flown
/// again differs by several times as much.
constexpr double equal_coverage = 5e-4;

/// The highest place of a route.
double top_of(const flight::Route& route) {
  double top = route.options.takeoff.z() + route.options.takeoff_climb;
  for (const flight::Station& station : route.stations) {
    top = std::max(top, station.view.position.z());
  }
  return top;
}

/// The problem of a mission, and what it asks.
class MissionProblem {
 public:
  MissionProblem(const file::Mission& mission, const GainField& surface,
                 const flight::FreeSpace& space, const flight::Route& present)
      : surface_(surface),
        space_(space),
        vehicle_(present.vehicle),
        limits_(derived::view_limits(mission)),
        motion_(present.vehicle, present.options.conditions),
        clearance_(present.clearance),
        returnable_(space, planning_law(present.options, top_of(present))),
        legs_(space, motion_, clearance_, no_ways_home_),
        home_(present.options.takeoff + Vector3d(0.0, 0.0, present.options.takeoff_climb)) {
    problem_.targets = surface.targets();
    problem_.home = home_;
    problem_.view_distance = derived::view_distance_of(mission);
    problem_.time_per_view = legs_
                                 .station_cost({.view = {},
                                                .hold = derived::hold_of(mission),
                                                .hold_after = derived::hold_after_of(mission)})
                                 .time;
    problem_.looks = [this](const View& view) { return surface_.looks(view); };
    problem_.view_of = [this](const Vector3d& target, const Vector3d& towards, double distance) {
      return limits_.view_of_target(target, towards, distance);
    };
    problem_.is_allowed = [this](const View& view) {
      return limits_.allow(view) && can_look(vehicle_, view);
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

 private:
  const Vector3d& place(const View* view) const { return view == nullptr ? home_ : view->position; }

  double straight_time(const View* from, const View* to) const {
    const double leg = motion_.leg_time(place(to) - place(from));
    if (from == nullptr || to == nullptr) return leg;
    const flight::Station there{.view = *to}, here{.view = *from};
    return legs_.aimed_time(leg, &here, &there);
  }

  const GainField& surface_;
  const flight::FreeSpace& space_;
  flight::Vehicle vehicle_;
  survey::ViewLimits limits_;
  flight::Motion motion_;
  double clearance_;
  flight::ReturnableSpace returnable_;
  std::optional<flight::WaysHome> no_ways_home_;
  flight::LegCertifier legs_;
  Vector3d home_;
  TourProblem problem_;
};

std::vector<View> views_of(const flight::Route& route) {
  std::vector<View> views;
  for (const flight::Station& station : route.stations) views.push_back(station.view);
  return views;
}

/// Stations and ways of a route as it is flown.
StationPlan stations_of(const flight::Route& route) {
  StationPlan plan{views_of(route), {}};
  plan.ways.resize(plan.views.size());
  for (std::size_t i = 1; i < plan.views.size(); ++i) plan.ways[i] = route.legs[i - 1].points;
  if (!route.sorties.empty()) plan.ways.front() = route.sorties.front().out.points;
  return plan;
}

/// Nothing if there is no such route: then what was there before is flown.
std::optional<flight::Route> certified(const PlanRoute& plan, const std::vector<View>& views) {
  try {
    return plan({views, std::vector<std::vector<Vector3d>>(views.size())});
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

MissionFigures figures_of(const flight::Route& route, double promised) {
  MissionFigures figures{.duration = route.duration,
                         .length = route.length,
                         .views = route.stations.size(),
                         .promised = promised};
  for (const flight::Sortie& sortie : route.sorties) {
    figures.pieces += sortie_points(route, sortie).size() - 1;
  }
  return figures;
}

MissionChoice choose_mission(const file::Mission& mission, const GainField& surface,
                             const flight::FreeSpace& space, const std::vector<View>& surveyed,
                             flight::Route present, const PlanRoute& plan,
                             const SearchSettings& settings, const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  const MissionProblem asked(mission, surface, space, present);
  const TourProblem& problem = asked.problem();
  const std::vector<View> views = views_of(present);
  MissionChoice choice;
  choice.survey = figures_of(present, covered_by(problem, views));
  choice.anew = choice.survey;
  choice.route = std::move(present);
  const double least = choice.survey.promised - equal_coverage;
  const double wanted = covered_by(problem, surveyed) - equal_coverage;
  const auto cost = [&](const MissionFigures& figures) {
    return figures.duration + 100.0 * settings.price * std::max(0.0, wanted - figures.promised);
  };

  const auto try_tour = [&](const FoundTour& tour) {
    if (stop.stop_requested()) return;
    std::optional<flight::Route> route = certified(plan, tour.views);
    if (!route) return;
    const MissionFigures figures = figures_of(*route, covered_by(problem, views_of(*route)));
    if (figures.promised < least || cost(figures) >= cost(choice.anew)) return;
    choice.anew = figures;
    choice.route = *std::move(route);
    choice.is_anew = true;
  };
  const FoundTour spared = spare_views(problem, views, least);
  if (spared.views.size() < views.size()) try_tour(spared);
  SearchSettings seeded = settings;
  seeded.seed = mission.seed;
  try_tour(anneal(problem, spared.views, wanted, seeded, stop));

  choice.stations = stations_of(choice.route);
  choice.computing =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return choice;
}

}  // namespace skycap::missions::anew
