/// The search for a flight that covers as much in fewer seconds: views that can be spared are
/// dropped, then views and tour are annealed together.
///
/// Source of the annealing: Kirkpatrick, Gelatt & Vecchi, Optimization by Simulated Annealing
/// (Science 220, 1983). The cost is the tour's time and a price for what is covered too little; the
/// temperature falls evenly on a logarithmic scale over a fixed number of moves, so that the same
/// inputs give the same tour on every machine.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "missions/package/replan/tour_problem.h"

namespace skycap::missions::package {

struct SearchSettings {
  std::size_t moves_per_view = 1'700;  ///< tried, by the views that it begins from
  double first_temperature = 4.0;      ///< [s]
  double last_temperature = 0.2;       ///< [s]
  double price = 150.0;                ///< of a hundredth of the surface that is missing [s]
  std::uint64_t seed = 1;
};

/// The tour without the views that can be spared: again and again the one that takes most time,
/// as long as `wanted` (a share of the targets' area) stays covered.
FoundTour spare_views(const TourProblem& problem, const std::vector<geometry::View>& tour,
                      double wanted);

/// The fastest tour found that covers what is wanted; it begins from `tour`, and is no slower than
/// that by its own reckoning if that covers as much. A stop that is requested ends it early.
FoundTour anneal(const TourProblem& problem, const std::vector<geometry::View>& tour, double wanted,
                 const SearchSettings& settings, const std::stop_token& stop = {});

/// What a tour through views is expected to cover: a share of the targets' area.
double covered_by(const TourProblem& problem, const std::vector<geometry::View>& views);

}  // namespace skycap::missions::package
