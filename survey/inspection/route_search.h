/// Search for the shortest flight that sees a structure: simulated annealing over the polygon of a
/// smoothed route, with seconds as the cost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "survey/inspection/first_tour.h"
#include "survey/inspection/reachable_space.h"
#include "survey/inspection/sight_cells.h"
#include "survey/inspection/smooth_route.h"

namespace skycap::survey::inspection {

/// Coverage that a route must reach.
struct CoverageGoal {
  /// Required fraction of the attainable points by rules A, B and C. Zero: not required.
  PerRule<double> shares{0.0, 0.0, 0.98};
  /// Samples of 0.4 s in which a point must be seen to count.
  int min_views = 1;

  /// Returns the lowest level of PointSight that matters.
  std::uint32_t min_level() const;
  /// Returns the number of the first `targets` points that may remain unseen by each rule.
  /// `attainable` has the highest attainable level of each point.
  PerRule<std::size_t> allowed_unseen(std::span<const std::uint8_t> attainable,
                                      std::size_t targets) const;
};

struct SearchOptions {
  MotionLimits limits;
  CoverageGoal goal;
  PitchRange pitch;
  std::size_t moves = 60'000;           ///< Budget: the number of tried moves.
  std::size_t first_phase_targets = 0;  ///< Points of the first phase; the last uses all of them.
  double last_phase_share = 0.15;       ///< Share of the moves in the last phase.
  double start_temperature = 1.0;       ///< Temperature of the annealing, which ends at 0.03 [s].
  double min_unseen_weight = 0.0;       ///< Minimum cost of a point above the goal [s].
  /// Per rule and point: samples that a point must be seen in addition to goal.min_views. Empty:
  /// none. For points that the evaluation does not see although the search counts them.
  PerRule<std::vector<std::uint8_t>> more_views{};
};

/// Route of a search.
struct SearchedRoute {
  std::vector<Vertex> vertices;
  double duration = 0.0;          ///< [s]
  PerRule<std::size_t> unseen{};  ///< Unseen points by the planner's count.
  std::size_t missing = 0;        ///< Unseen points above the goal, over all rules.
  bool meets_goal() const { return missing == 0; }
};

struct SearchResult {
  /// Routes of the last phase without a penalty, each better than the one before it: first fewer
  /// points above the goal, then shorter. Empty: none.
  std::vector<SearchedRoute> improvements;
  SearchedRoute last;           ///< Final route of the search, which may have penalties.
  double first_duration = 0.0;  ///< Duration of the first tour [s].
  std::size_t evaluated = 0;    ///< Moves that were evaluated beyond their duration.
  std::size_t accepted = 0;
};

/// Receives the share of the budget that is used, and the duration of the current route [s].
using SearchProgress = std::function<void(double share, double duration)>;

/// Searches from the vertices `first`. The result depends only on the arguments and the state of
/// `random`. After a stop request, returns what was found.
SearchResult search_route(const ReachableSpace& space, const SightCells& cells,
                          const ViewCandidates& candidates, std::vector<Vertex> first,
                          const SearchOptions& options, geometry::RandomNumbers& random,
                          const std::stop_token& stop, const SearchProgress& progress = {});

/// Penalty of a route for violated clearance, height, acceleration and jerk [s].
double route_penalty(const ReachableSpace& space, std::span<const Vertex> vertices,
                     const MotionLimits& limits);

}  // namespace skycap::survey::inspection
