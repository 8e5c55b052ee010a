/// Stops of a tour and durations of its legs.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "missions/package/replan/observation_sum.h"
#include "missions/package/replan/tour_problem.h"

namespace skycap::missions::package {

/// View with the doses of its observations.
struct Stop {
  geometry::View view;
  std::uint32_t number;  ///< Number that is unique within a search, from 1.
  std::vector<ObservationStrength> strengths{};
};

/// Stops in tour order. Tours share their stops because most of them differ in only one or two.
using Stops = std::vector<std::shared_ptr<const Stop>>;

/// Cache of leg durations. Keeps a reference to the problem.
class LegTimes {
 public:
  explicit LegTimes(const TourProblem& problem) : problem_(problem) {}

  /// Returns a lower bound on the duration of a tour [s], including rest times. Unchecked legs
  /// count as free.
  double min(const Stops& stops);

  /// Checks one more leg of the tour for collisions. Returns false if all legs have been checked.
  bool ask_next(const Stops& stops);

  /// Checks all legs and the returns from them. Returns the duration of the tour [s].
  double verified_time(const Stops& stops);

 private:
  double bends(const Stops& stops) const;

  struct Leg {
    double straight = -1.0;  ///< Duration [s]; negative if unknown.
    bool is_asked = false, is_verified = false, is_blocked = false;
  };

  template <typename Visit>
  void for_each_leg(const Stops& stops, Visit visit);

  const TourProblem& problem_;
  /// Legs by the numbers of both stops, combined in the key.
  std::unordered_map<std::uint64_t, Leg> legs_;
};

}  // namespace skycap::missions::package
