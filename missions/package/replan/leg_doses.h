/// Observations on the paths of a tour, for sensors that measure continuously.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "missions/package/replan/leg_times.h"
#include "missions/package/replan/observation_sum.h"
#include "missions/package/replan/tour_problem.h"

namespace skycap::missions::package {

/// Cache of the doses of each straight path, which are independent of its direction. Keeps a
/// reference to the problem.
class LegDoses {
 public:
  explicit LegDoses(const TourProblem& problem) : problem_(problem) {}

  /// Replaces the doses of the tour `from` in the sum by those of the tour `to`. Paths in both
  /// tours are not evaluated.
  void change(ObservationSum& sum, const Stops& from, const Stops& to);

 private:
  const std::vector<ObservationStrength>& strengths(const Stop* a, const Stop* b);

  const TourProblem& problem_;
  /// Doses by path; the key contains the numbers of both stops.
  std::unordered_map<std::uint64_t, std::vector<ObservationStrength>> strengths_;
};

}  // namespace skycap::missions::package
