/// Visiting order for waypoints, with a lower bound on its cost.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace skycap::flight {

struct Tour {
  /// Order of nodes 1 .. count-1. The tour starts and ends at node 0.
  std::vector<std::uint32_t> order;
  double cost = 0.0;
  double lower_bound = 0.0;  ///< Lower bound on the cost of every tour (Held & Karp 1-trees).
};

/// Computes a closed tour through nodes 0 .. count-1 with symmetric costs `cost(a, b)`.
/// Nearest-neighbour construction is followed by 2-opt and Or-opt until neither improves the tour.
/// Deterministic. Needs O(count^2) memory and about O(count^2) time per pass: seconds for 1000
/// nodes.
Tour plan_tour(std::uint32_t count,
               const std::function<double(std::uint32_t, std::uint32_t)>& cost);

}  // namespace skycap::flight
