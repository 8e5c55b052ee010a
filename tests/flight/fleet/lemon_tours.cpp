// LEMON 1.3.1 uses allocator members that C++20 removed. This source is therefore compiled as
// C++17.
#include "tests/flight/fleet/lemon_tours.h"

#include <algorithm>

#include <lemon/christofides_tsp.h>
#include <lemon/full_graph.h>
#include <lemon/greedy_tsp.h>
#include <lemon/insertion_tsp.h>
#include <lemon/nearest_neighbor_tsp.h>
#include <lemon/opt2_tsp.h>

namespace skycap::flight {
namespace {

using Costs = lemon::FullGraph::EdgeMap<double>;

/// Returns a heuristic's tour length after 2-opt.
template <typename Heuristic>
double improved(const lemon::FullGraph& graph, const Costs& costs) {
  Heuristic heuristic(graph, costs);
  heuristic.run();
  lemon::Opt2Tsp<Costs> opt2(graph, costs);
  return opt2.run(heuristic.tourNodes());
}

}  // namespace

double lemon_tour(std::size_t count, const std::vector<double>& costs) {
  const lemon::FullGraph graph(static_cast<int>(count));
  Costs lengths(graph);
  for (int i = 0; i < graph.nodeNum(); ++i) {
    for (int j = 0; j < i; ++j) {
      lengths[graph.edge(graph(i), graph(j))] = costs[static_cast<std::size_t>(i) * count + j];
    }
  }
  return std::min({improved<lemon::NearestNeighborTsp<Costs>>(graph, lengths),
                   improved<lemon::GreedyTsp<Costs>>(graph, lengths),
                   improved<lemon::InsertionTsp<Costs>>(graph, lengths),
                   improved<lemon::ChristofidesTsp<Costs>>(graph, lengths)});
}

}  // namespace skycap::flight
