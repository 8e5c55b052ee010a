/// A good order for stations whose order is free, with a proof of how good: a lower bound.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace skycap::flight {

struct Tour {
  std::vector<std::uint32_t> order;  ///< of the places 1 .. count-1; the tour starts and ends at 0
  double cost = 0.0;
  double lower_bound = 0.0;  ///< no tour costs less (Held & Karp 1-trees)
};

/// A closed tour through places 0 .. count-1 at symmetric costs `cost(a, b)`: nearest neighbour,
/// then 2-opt and Or-opt until neither helps. Deterministic; O(count^2) memory and about O(count^2)
/// a round: seconds for a thousand places.
Tour plan_tour(std::uint32_t count,
               const std::function<double(std::uint32_t, std::uint32_t)>& cost);

}  // namespace skycap::flight
