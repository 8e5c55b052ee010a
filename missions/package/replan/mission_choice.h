/// The mission that a survey leaves, chosen anew: stations from which a flight covers what the
/// survey's views cover, as far as the planner knows the surface, in fewer seconds.
///
/// Nothing here knows the scene: what views see is decided by the planner's own surfels
/// (survey/skycap/view_gain.h), where they may be by the space that was measured free, and what is
/// written is a certified route.
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "flight/flight_options.h"
#include "flight/route/route.h"
#include "flight/space/clearance.h"
#include "geometry/place/pose.h"
#include "missions/package/replan/tour_search.h"
#include "sim/sensors/scanner_field.h"
#include "survey/planners/planner_options.h"
#include "survey/skycap/view_gain.h"

namespace skycap::missions::package {

/// What a mission takes and what it brings.
struct MissionFigures {
  double duration = 0.0;  ///< [s]
  double length = 0.0;
  std::size_t views = 0;
  std::size_t pieces = 0;  ///< the vehicle stops after each
  double promised = 0.0;   ///< expected covered share of what the survey measured
};

/// The figures of a certified route.
MissionFigures figures_of(const flight::Route& route, double promised);

/// Stations in an order that is kept, and how to come to each from the one before or from above the
/// pad; no way where it is to be found.
struct StationPlan {
  std::vector<geometry::View> views;
  std::vector<std::vector<Eigen::Vector3d>> ways;
};

struct MissionChoice {
  flight::Route route;     ///< the better one of the two
  bool is_anew = false;    ///< whether that is the one chosen anew
  StationPlan stations;    ///< of the route
  MissionFigures survey;   ///< of the survey's views that have a way home
  MissionFigures anew;     ///< of the best found; as `survey` if nothing better was
  double computing = 0.0;  ///< that it took, certified routes included [s]
};

/// The certified route through views in the order given.
using PlanRoute = std::function<flight::Route(const StationPlan&)>;

/// What the choice depends on besides flight and planner.
struct ChoiceOptions {
  SearchSettings search;
  sim::ScannerKind scanner = sim::ScannerKind::ring;  ///< of one that measures all the way
  unsigned threads = 0;  ///< zero: all processors; does not change the result
};

/// Begins from `present`, the route through the survey's views that have a proven way home, and
/// falls back on it: the choice never promises less, and is slower only where it covers what else
/// the survey has seen from `surveyed`, its views and those of frames on its ways, at the price in
/// `options`. `space` is what the route is proven in. Tours that `plan` throws an Error at are not
/// flown. If a stop is requested, the choice is what was found by then.
MissionChoice choose_mission(const flight::FlightOptions& flight,
                             const survey::PlannerOptions& planner, const ChoiceOptions& options,
                             const survey::skycap::GainField& surface,
                             const flight::FreeSpace& space,
                             const std::vector<geometry::View>& surveyed, flight::Route present,
                             const PlanRoute& plan, const std::stop_token& stop = {});

}  // namespace skycap::missions::package
