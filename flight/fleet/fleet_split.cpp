#include "flight/fleet/fleet_split.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "geometry/parallel.h"

namespace skycap::flight {
namespace {

using Order = std::vector<std::uint32_t>;

SplitProblem split_problem(const FleetVehicle& vehicle, std::span<const std::uint32_t> stations) {
  SplitProblem problem{.energy_per_sortie = vehicle.energy_per_sortie,
                       .stations_per_sortie = vehicle.stations_per_sortie};
  SplitProblem::Pad& pad = problem.pads.emplace_back();
  for (std::size_t i = 0; i < stations.size(); ++i) {
    pad.out.push_back(vehicle.out[stations[i]]);
    problem.station.push_back(vehicle.station[stations[i]]);
    pad.back.push_back(vehicle.back[stations[i]]);
    if (i > 0) problem.leg.push_back(vehicle.leg(stations[i - 1], stations[i]));
  }
  return problem;
}

/// Returns the time of one sortie to all waypoints [s], infinite if the battery does not suffice.
double sortie_time(const FleetVehicle& vehicle, std::span<const std::uint32_t> stations) {
  if (stations.size() > vehicle.stations_per_sortie) return never;
  PartCost sum = vehicle.out[stations.front()];
  const auto add = [&](const PartCost& part) {
    sum.emergency = std::max(sum.emergency, sum.energy + part.emergency);
    sum.time += part.time;
    sum.energy += part.energy;
  };
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (i > 0) add(vehicle.leg(stations[i - 1], stations[i]));
    add(vehicle.station[stations[i]]);
  }
  add(vehicle.back[stations.back()]);
  if (std::max(sum.energy, sum.emergency) > vehicle.energy_per_sortie) return never;
  return sum.time;
}

FleetSplit added_up(std::vector<FleetPart> parts) {
  FleetSplit split{.parts = std::move(parts)};
  for (const FleetPart& part : split.parts) {
    split.makespan = std::max(split.makespan, part.time);
    split.flown += part.time;
  }
  return split;
}

/// Objectives of a split, compared with the goal first.
struct Worth {
  double makespan = 0.0, flown = 0.0;

  bool is_better_than(const Worth& other, FleetGoal goal) const {
    if (goal == FleetGoal::flown) {
      return flown < other.flown || (flown == other.flown && makespan < other.makespan);
    }
    return makespan < other.makespan || (makespan == other.makespan && flown < other.flown);
  }
};

}  // namespace

double part_time(const FleetVehicle& vehicle, std::span<const std::uint32_t> stations) {
  if (stations.empty()) return 0.0;
  if (const double time = sortie_time(vehicle, stations); time < never) return time;
  const SortieSplit split = split_into_sorties(split_problem(vehicle, stations));
  if (split.sorties.empty()) return never;
  return split.time;
}

FleetSplit split_among(const FleetProblem& problem, std::span<const std::uint32_t> order,
                       FleetGoal goal) {
  const std::size_t count = order.size(), vehicles = problem.vehicles.size();
  constexpr Worth none{never, never};
  // For the waypoints before i, with the vehicles so far.
  std::vector<Worth> best(count + 1, none);
  best[0] = {};
  std::vector<std::vector<std::size_t>> first_of(vehicles, std::vector<std::size_t>(count + 1));
  for (std::size_t v = 0; v < vehicles; ++v) {
    std::vector<Worth> next(count + 1, none);
    for (std::size_t first = 0; first <= count; ++first) {
      if (best[first].flown == never) continue;
      for (std::size_t end = first; end <= count; ++end) {
        const double time = part_time(problem.vehicles[v], order.subspan(first, end - first));
        if (time == never) break;  // More waypoints only take longer.
        const Worth worth{std::max(best[first].makespan, time), best[first].flown + time};
        if (!worth.is_better_than(next[end], goal)) continue;
        next[end] = worth;
        first_of[v][end] = first;
      }
    }
    best = std::move(next);
  }
  if (best[count].flown == never) return {};
  std::vector<FleetPart> parts(vehicles);
  for (std::size_t v = vehicles, end = count; v-- > 0; end = first_of[v][end]) {
    const auto run = order.subspan(first_of[v][end], end - first_of[v][end]);
    parts[v] = {Order(run.begin(), run.end()), part_time(problem.vehicles[v], run)};
  }
  return added_up(std::move(parts));
}

FleetSplit share_sorties(const FleetProblem& problem, std::span<const std::uint32_t> order) {
  const FleetVehicle& lead = problem.vehicles.front();
  const SortieSplit split = split_into_sorties(split_problem(lead, order));
  if (split.sorties.empty()) return {};
  std::vector<std::pair<double, std::span<const std::uint32_t>>> sorties;
  for (const SortieRange& range : split.sorties) {
    const auto run = order.subspan(range.first, range.last - range.first + 1);
    sorties.emplace_back(sortie_time(lead, run), run);
  }
  std::ranges::stable_sort(sorties, std::greater(), &decltype(sorties)::value_type::first);
  std::vector<FleetPart> parts(problem.vehicles.size());
  for (const auto& [time, run] : sorties) {
    FleetPart* least = nullptr;
    FleetPart given;
    for (std::size_t v = 0; v < parts.size(); ++v) {
      FleetPart longer = parts[v];
      longer.stations.insert(longer.stations.end(), run.begin(), run.end());
      longer.time = part_time(problem.vehicles[v], longer.stations);
      if (least != nullptr && longer.time >= given.time) continue;
      least = &parts[v];
      given = std::move(longer);
    }
    if (given.time == never) return {};
    *least = std::move(given);
  }
  return added_up(std::move(parts));
}

FleetSplit share_among(const FleetProblem& problem, std::span<const std::uint32_t> order,
                       FleetGoal goal, std::size_t chains, unsigned threads) {
  FleetSplit best;
  const auto keep = [&](FleetSplit split) {
    if (split.parts.empty()) return;
    split = exchanged(problem, std::move(split), goal);
    const bool is_better = best.parts.empty() || Worth{split.makespan, split.flown}.is_better_than(
                                                     {best.makespan, best.flown}, goal);
    if (is_better) best = std::move(split);
  };
  keep(split_among(problem, order, goal));
  keep(share_sorties(problem, order));
  if (best.parts.empty()) return best;
  std::vector<FleetSplit> cooled(chains);
  geometry::parallel_for(chains, threads, [&](std::size_t chain) {
    cooled[chain] = annealed(problem, best, goal, chain);
  });
  for (FleetSplit& split : cooled) keep(std::move(split));
  return best;
}

}  // namespace skycap::flight
