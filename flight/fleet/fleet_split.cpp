#include "flight/fleet/fleet_split.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "geometry/parallel.h"

namespace skycap::flight {
namespace {

using Order = std::vector<std::uint32_t>;

SplitProblem split_problem(const FleetVehicle& vehicle,
                           std::span<const std::uint32_t> capture_points) {
  SplitProblem problem{.energy_per_sortie = vehicle.energy_per_sortie,
                       .capture_points_per_sortie = vehicle.capture_points_per_sortie};
  SplitProblem::Pad& pad = problem.pads.emplace_back();
  for (std::size_t i = 0; i < capture_points.size(); ++i) {
    pad.out.push_back(vehicle.out[capture_points[i]]);
    problem.capture_point.push_back(vehicle.capture_point[capture_points[i]]);
    pad.back.push_back(vehicle.back[capture_points[i]]);
    if (i > 0) problem.leg.push_back(vehicle.leg(capture_points[i - 1], capture_points[i]));
  }
  return problem;
}

/// Returns the time of one sortie to all waypoints [s], infinite if the battery does not suffice.
double sortie_time(const FleetVehicle& vehicle, std::span<const std::uint32_t> capture_points) {
  if (capture_points.size() > vehicle.capture_points_per_sortie) return never;
  PartCost sum = vehicle.out[capture_points.front()];
  const auto add = [&](const PartCost& part) {
    sum.emergency = std::max(sum.emergency, sum.energy + part.emergency);
    sum.time += part.time;
    sum.energy += part.energy;
  };
  for (std::size_t i = 0; i < capture_points.size(); ++i) {
    if (i > 0) add(vehicle.leg(capture_points[i - 1], capture_points[i]));
    add(vehicle.capture_point[capture_points[i]]);
  }
  add(vehicle.back[capture_points.back()]);
  if (std::max(sum.energy, sum.emergency) > vehicle.energy_per_sortie) return never;
  return sum.time;
}

FleetSplit added_up(std::vector<FleetPart> parts) {
  FleetSplit split{.parts = std::move(parts)};
  for (const FleetPart& part : split.parts) {
    split.makespan = std::max(split.makespan, part.time);
    split.total_flight_time += part.time;
  }
  return split;
}

/// Objectives of a split, compared with the goal first.
struct Worth {
  double makespan = 0.0, total_flight_time = 0.0;

  bool is_better_than(const Worth& other, FleetGoal goal) const {
    if (goal == FleetGoal::total_flight_time) {
      return total_flight_time < other.total_flight_time ||
             (total_flight_time == other.total_flight_time && makespan < other.makespan);
    }
    return makespan < other.makespan ||
           (makespan == other.makespan && total_flight_time < other.total_flight_time);
  }
};

}  // namespace

double part_time(const FleetVehicle& vehicle, std::span<const std::uint32_t> capture_points) {
  if (capture_points.empty()) return 0.0;
  if (const double time = sortie_time(vehicle, capture_points); time < never) return time;
  const SortieSplit split = split_into_sorties(split_problem(vehicle, capture_points));
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
  std::vector<std::vector<std::size_t>> run_starts(vehicles, std::vector<std::size_t>(count + 1));
  for (std::size_t v = 0; v < vehicles; ++v) {
    std::vector<Worth> next(count + 1, none);
    for (std::size_t first = 0; first <= count; ++first) {
      if (best[first].total_flight_time == never) continue;
      for (std::size_t end = first; end <= count; ++end) {
        const double time = part_time(problem.vehicles[v], order.subspan(first, end - first));
        if (time == never) break;  // More waypoints only take longer.
        const Worth worth{std::max(best[first].makespan, time),
                          best[first].total_flight_time + time};
        if (!worth.is_better_than(next[end], goal)) continue;
        next[end] = worth;
        run_starts[v][end] = first;
      }
    }
    best = std::move(next);
  }
  if (best[count].total_flight_time == never) return {};
  std::vector<FleetPart> parts(vehicles);
  for (std::size_t v = vehicles, end = count; v-- > 0; end = run_starts[v][end]) {
    const auto run = order.subspan(run_starts[v][end], end - run_starts[v][end]);
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
    FleetPart* min = nullptr;
    FleetPart given;
    for (std::size_t v = 0; v < parts.size(); ++v) {
      FleetPart longer = parts[v];
      longer.capture_points.insert(longer.capture_points.end(), run.begin(), run.end());
      longer.time = part_time(problem.vehicles[v], longer.capture_points);
      if (min != nullptr && longer.time >= given.time) continue;
      min = &parts[v];
      given = std::move(longer);
    }
    if (given.time == never) return {};
    *min = std::move(given);
  }
  return added_up(std::move(parts));
}

FleetSplit share_among(const FleetProblem& problem, std::span<const std::uint32_t> order,
                       FleetGoal goal, std::size_t chains, unsigned threads) {
  FleetSplit best;
  const auto keep = [&](FleetSplit split) {
    if (split.parts.empty()) return;
    split = exchanged(problem, std::move(split), goal);
    const bool is_better =
        best.parts.empty() || Worth{split.makespan, split.total_flight_time}.is_better_than(
                                  {best.makespan, best.total_flight_time}, goal);
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
