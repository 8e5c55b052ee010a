/// Tours by LEMON, an independent library of graph algorithms: twins of what fleets fly.
#pragma once

#include <cstddef>
#include <vector>

namespace skycap::flight {

/// The shortest tour that LEMON's heuristics find (nearest neighbour, greedy, insertion,
/// Christofides, 2-opt after each) through all of `count` places at the symmetric costs
/// costs[i * count + j].
double lemon_tour(std::size_t count, const std::vector<double>& costs);

}  // namespace skycap::flight
