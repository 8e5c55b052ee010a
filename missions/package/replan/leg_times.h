/// The stops of a tour, and what its legs take.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "missions/package/replan/dose_sum.h"
#include "missions/package/replan/tour_problem.h"

namespace skycap::missions::package {

/// A view with what it brings.
struct Stop {
  geometry::View view;
  std::uint32_t number;  ///< no other stop of a search has it; from 1 on
  std::vector<Dose> doses{};
};

/// In the order of a tour. Tours share them: most differ in a stop or two.
using Stops = std::vector<std::shared_ptr<const Stop>>;

/// Finds the time of each leg once. Keeps a reference to the problem.
class LegTimes {
 public:
  explicit LegTimes(const TourProblem& problem) : problem_(problem) {}

  /// Of a tour [s], rests included; legs that nobody has asked about yet count as free.
  double least(const Stops& stops);

  /// Asks whether one more leg of the tour is free, if there is one.
  bool ask_next(const Stops& stops);

  /// Of a tour whose every leg has been asked about, and for its ways home too.
  double proven(const Stops& stops);

 private:
  double bends(const Stops& stops) const;

  struct Leg {
    double straight = -1.0;  ///< negative: not known yet
    bool is_asked = false, is_proven = false, is_blocked = false;
  };

  template <typename Visit>
  void for_each_leg(const Stops& stops, Visit visit);

  const TourProblem& problem_;
  std::unordered_map<std::uint64_t, Leg> legs_;  ///< by the numbers of both ends
};

}  // namespace skycap::missions::package
