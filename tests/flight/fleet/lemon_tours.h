/// Tours computed by LEMON, an independent graph library, as reference for fleet tours.
#pragma once

#include <cstddef>
#include <vector>

namespace skycap::flight {

/// Returns the length of the shortest tour that LEMON's heuristics find through all `count` points
/// (nearest neighbour, greedy, insertion, Christofides, each followed by 2-opt). The costs costs[i
/// * count + j] are symmetric.
double lemon_tour(std::size_t count, const std::vector<double>& costs);

}  // namespace skycap::flight
