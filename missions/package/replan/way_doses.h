/// What is measured on the ways of a tour, for flights that measure all the time.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "missions/package/replan/dose_sum.h"
#include "missions/package/replan/leg_times.h"
#include "missions/package/replan/tour_problem.h"

namespace skycap::missions::package {

/// Finds the doses of each straight way once; either direction gives the same. Keeps a reference to
/// the problem.
class WayDoses {
 public:
  explicit WayDoses(const TourProblem& problem) : problem_(problem) {}

  /// Takes the ways of one tour out of the sum, and adds those of the other. Of ways that both have
  /// nothing is asked.
  void change(DoseSum& sum, const Stops& from, const Stops& to);

 private:
  const std::vector<Dose>& doses(const Stop* a, const Stop* b);

  const TourProblem& problem_;
  std::unordered_map<std::uint64_t, std::vector<Dose>> doses_;  ///< by the numbers of both ends
};

}  // namespace skycap::missions::package
