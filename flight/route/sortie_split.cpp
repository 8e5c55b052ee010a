#include "flight/route/sortie_split.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skycap::flight {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// What time any split takes at least: every way from station to station flown direct or by the
/// pad, whichever is faster, and as many visits to the pad as the energy of all that asks for.
double least_time(const SplitProblem& problem) {
  const std::size_t count = problem.out.size();
  double time = problem.out.front().time + problem.back.back().time;
  double energy = problem.out.front().energy + problem.back.back().energy;
  double cheapest_visit = never;
  for (std::size_t i = 0; i < count; ++i) {
    time += problem.station[i].time;
    energy += problem.station[i].energy;
    if (i + 1 == count) break;
    const double by_pad = problem.back[i].time + problem.out[i + 1].time;
    const double by_pad_energy = problem.back[i].energy + problem.out[i + 1].energy;
    time += std::min(problem.leg[i].time, by_pad);
    energy += std::min(problem.leg[i].energy, by_pad_energy);
    cheapest_visit = std::min(cheapest_visit, std::max(0.0, by_pad - problem.leg[i].time));
  }
  const double by_energy = std::ceil(energy / problem.energy_per_sortie);
  const double by_count =
      std::ceil(static_cast<double>(count) / static_cast<double>(problem.stations_per_sortie));
  const double visits = std::max(by_energy, by_count) - 1.0;
  return time + (visits > 0.0 ? visits * cheapest_visit : 0.0);
}

}  // namespace

SortieSplit split_into_sorties(const SplitProblem& problem) {
  const std::size_t count = problem.out.size();
  if (count == 0) return {};
  std::vector<double> best_time(count + 1, never);  // of the stations before i
  std::vector<std::size_t> first_of_last(count + 1, 0);
  best_time[0] = 0.0;
  for (std::size_t first = 0; first < count; ++first) {
    if (best_time[first] == never) continue;
    double time = problem.out[first].time, energy = problem.out[first].energy;
    const std::size_t end = std::min(count, first + problem.stations_per_sortie);
    double worst = problem.out[first].emergency;
    const auto add = [&](const SplitProblem::Cost& part) {
      worst = std::max(worst, energy + part.emergency);
      time += part.time;
      energy += part.energy;
    };
    for (std::size_t last = first; last < end; ++last) {
      if (last > first) add(problem.leg[last - 1]);
      add(problem.station[last]);
      if (std::max(energy, worst) > problem.energy_per_sortie) break;
      // The way home from here must be affordable, or the vehicle should not have come this far.
      const SplitProblem::Cost& back = problem.back[last];
      if (energy + std::max(back.energy, back.emergency) > problem.energy_per_sortie) break;
      const double total = best_time[first] + time + problem.back[last].time;
      if (total < best_time[last + 1]) {
        best_time[last + 1] = total;
        first_of_last[last + 1] = first;
      }
    }
  }
  SortieSplit split;
  if (best_time[count] == never) return split;
  for (std::size_t end = count; end > 0; end = first_of_last[end]) {
    split.sorties.push_back(
        {static_cast<std::uint32_t>(first_of_last[end]), static_cast<std::uint32_t>(end - 1)});
  }
  std::reverse(split.sorties.begin(), split.sorties.end());
  split.time = best_time[count];
  split.time_bound = least_time(problem);
  return split;
}

}  // namespace skycap::flight
