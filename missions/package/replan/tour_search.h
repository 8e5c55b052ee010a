/// Search for a faster flight with the same coverage. Redundant views are removed, then views and
/// tour are optimised together by simulated annealing.
///
/// Source: Kirkpatrick, Gelatt & Vecchi, Optimization by Simulated Annealing (Science 220, 1983).
/// The cost is the duration of the tour plus a price for missing coverage. The temperature
/// decreases exponentially over a fixed number of moves, so that equal inputs give equal tours on
/// all machines.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "missions/package/replan/tour_problem.h"

namespace skycap::missions::package {

struct SearchSettings {
  std::size_t moves_per_view = 1'700;  ///< Number of moves per view of the initial tour.
  double first_temperature = 4.0;      ///< [s]
  double last_temperature = 0.2;       ///< [s]
  double price = 150.0;                ///< Cost per 1% of missing surface [s].
  std::uint64_t seed = 1;
};

/// Repeatedly removes the view whose removal saves the most time, while the covered fraction of the
/// targets' area stays at least `target_coverage`.
FoundTour remove_views(const TourProblem& problem, const std::vector<geometry::View>& tour,
                       double target_coverage);

/// Returns the fastest tour found that covers the fraction `target_coverage`. The search starts
/// from `tour`. If `tour` has this coverage, the result is not slower by the estimates of the
/// search. A stop request ends the search early.
FoundTour anneal(const TourProblem& problem, const std::vector<geometry::View>& tour,
                 double target_coverage, const SearchSettings& settings,
                 const std::stop_token& stop = {});

/// Returns the expected covered fraction of the targets' area for a tour through `views`.
double covered_by(const TourProblem& problem, const std::vector<geometry::View>& views);

}  // namespace skycap::missions::package
