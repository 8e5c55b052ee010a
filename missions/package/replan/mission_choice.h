/// Replanning of a finished survey: selects stations that cover the surface known to the planner as
/// well as the survey's views, in less flight time.
///
/// Replanning does not use the scene. The planner's surfels define what views observe
/// (survey/surfel/view_gain.h), and the free space of the survey defines where views are allowed.
/// The result is a verified route.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/flight_options.h"
#include "flight/route/route.h"
#include "geometry/pose/pose.h"
#include "missions/package/replan/measured_surface.h"
#include "missions/package/replan/tour_search.h"
#include "sim/sensors/scanner_field.h"
#include "survey/planners/planner_options.h"
#include "survey/surfel/view_gain.h"

namespace skycap::missions::package {

/// Cost and coverage of a mission.
struct MissionFigures {
  double duration = 0.0;  ///< [s]
  double length = 0.0;
  std::size_t views = 0;
  std::size_t segments = 0;  ///< Number of path segments; the vehicle stops after each.
  double predicted_coverage =
      0.0;  ///< Predicted covered fraction of the surface measured by the survey.
  /// Predicted fraction of the measured points (ChoiceOptions::measured) that a re-flight measures
  /// again. Empty without such points.
  std::optional<double> predicted_reflight{};
};

/// Returns the figures of a verified route with the given predicted coverage.
MissionFigures compute_figures(const flight::Route& route, double predicted_coverage);

/// Stations in fixed order, with the path to each from the previous station or from above the pad.
/// Empty paths are planned later.
struct CapturePlan {
  std::vector<geometry::View> views;
  std::vector<std::vector<Eigen::Vector3d>> paths;
};

struct MissionChoice {
  flight::Route route;         ///< The better of the two routes.
  bool is_replanned = false;   ///< True if the replanned route is the better one.
  CapturePlan capture_points;  ///< Stations of the route.
  MissionFigures survey;       ///< Figures of the survey's views that have a verified return.
  /// Figures of the best replanned mission, or of the fastest rejected one. Equal to `survey` if
  /// none was found.
  MissionFigures replanned;
  std::string reason;  ///< Reason for the selection, as a clause.
  /// Duration of a verified fly-through of the stations [s], if it is faster than the flight with
  /// stops that the route contains.
  std::optional<double> fly_through_duration;
  double computing = 0.0;  ///< Computation time including verification of routes [s].
};

/// Plans a verified route through views in fixed order.
using PlanRoute = std::function<flight::Route(const CapturePlan&)>;

/// Options for replanning in addition to those of flight and planner.
struct ChoiceOptions {
  SearchSettings search;
  sim::ScannerKind scanner = sim::ScannerKind::ring;  ///< Type of a continuously measuring scanner.
  unsigned threads = 0;  ///< Number of threads (0: all processors). Does not affect the result.
  /// Points of the survey, for the sight of views and for predicted re-flights. Null: neither.
  const MeasuredSurface* measured = nullptr;
  /// Rejects missions whose predicted re-flight covers less than that of the survey's views, by
  /// more than 0.3 percentage points. Requires `measured`.
  bool keeps_reflight = false;
};

/// Improves `present`, the route through the survey's views with a verified return, and falls back
/// to it. The selected mission never has a lower predicted coverage. It is slower only if it
/// additionally covers surface observed from `surveyed`, at the price set in `options`. `surveyed`
/// contains the survey's views and its en-route frames. Routes are verified in `space`. Tours for
/// which `plan` throws an Error are rejected. After a stop request, returns `present`.
MissionChoice choose_mission(const flight::FlightOptions& flight,
                             const survey::PlannerOptions& planner, const ChoiceOptions& options,
                             const survey::surfel::GainField& surface,
                             const flight::FreeSpace& space,
                             const std::vector<geometry::View>& surveyed, flight::Route present,
                             const PlanRoute& plan, const std::stop_token& stop = {});

}  // namespace skycap::missions::package
