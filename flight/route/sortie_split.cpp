#include "flight/route/sortie_split.h"

#include <algorithm>
#include <cmath>

namespace skycap::flight {
namespace {

using Cost = SplitProblem::Cost;

/// Returns the minimum over all pads of one figure of a waypoint.
double min(const SplitProblem& problem, std::vector<Cost> SplitProblem::Pad::*cost, std::size_t i,
           double Cost::*figure) {
  double best = never;
  for (const SplitProblem::Pad& pad : problem.pads) best = std::min(best, (pad.*cost)[i].*figure);
  return best;
}

/// Returns a lower bound for every split [s]. Each pair of waypoints is connected directly or via a
/// pad, whichever is faster. The number of pad visits is the minimum that the total energy
/// requires.
double min_time(const SplitProblem& problem) {
  const std::size_t count = problem.capture_point.size();
  const auto out = [&](std::size_t i, double Cost::*figure) {
    return min(problem, &SplitProblem::Pad::out, i, figure);
  };
  const auto back = [&](std::size_t i, double Cost::*figure) {
    return min(problem, &SplitProblem::Pad::back, i, figure);
  };
  double time = out(0, &Cost::time) + back(count - 1, &Cost::time);
  double energy = out(0, &Cost::energy) + back(count - 1, &Cost::energy);
  double cheapest_visit = never;
  for (std::size_t i = 0; i < count; ++i) {
    time += problem.capture_point[i].time;
    energy += problem.capture_point[i].energy;
    if (i + 1 == count) break;
    const double by_pad = back(i, &Cost::time) + out(i + 1, &Cost::time);
    const double by_pad_energy = back(i, &Cost::energy) + out(i + 1, &Cost::energy);
    time += std::min(problem.leg[i].time, by_pad);
    energy += std::min(problem.leg[i].energy, by_pad_energy);
    cheapest_visit = std::min(cheapest_visit, std::max(0.0, by_pad - problem.leg[i].time));
  }
  const double by_energy = std::ceil(energy / problem.energy_per_sortie);
  const double by_count = std::ceil(static_cast<double>(count) /
                                    static_cast<double>(problem.capture_points_per_sortie));
  const double visits = std::max(by_energy, by_count) - 1.0;
  return time + (visits > 0.0 ? visits * cheapest_visit : 0.0);
}

/// Best split of the waypoints before each index.
struct BestSplits {
  explicit BestSplits(std::size_t count) : time(count + 1, never), last(count + 1) {
    time[0] = 0.0;
  }
  std::vector<double> time;
  std::vector<SortieRange> last;  ///< Last sortie of that split.
};

/// Evaluates all sorties from a pad that start at waypoint `first`.
void extend(const SplitProblem& problem, std::uint32_t pad_number, std::size_t first,
            BestSplits& best) {
  const SplitProblem::Pad& pad = problem.pads[pad_number];
  const std::size_t end =
      std::min(problem.capture_point.size(), first + problem.capture_points_per_sortie);
  double time = pad.out[first].time, energy = pad.out[first].energy;
  double worst = pad.out[first].emergency;
  std::size_t waypoints = pad.out[first].waypoints;
  const auto add = [&](const Cost& part) {
    worst = std::max(worst, energy + part.emergency);
    time += part.time;
    energy += part.energy;
    waypoints += part.waypoints;
  };
  for (std::size_t last = first; last < end; ++last) {
    if (last > first) add(problem.leg[last - 1]);
    add(problem.capture_point[last]);
    if (std::max(energy, worst) > problem.energy_per_sortie) break;
    if (waypoints > problem.waypoints_per_sortie) break;
    // The return from here must be affordable, otherwise the vehicle must not fly this far.
    const Cost& back = pad.back[last];
    if (energy + std::max(back.energy, back.emergency) > problem.energy_per_sortie) break;
    if (waypoints + back.waypoints > problem.waypoints_per_sortie) continue;
    const double total = best.time[first] + time + back.time;
    if (total >= best.time[last + 1]) continue;
    best.time[last + 1] = total;
    best.last[last + 1] = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last),
                           pad_number};
  }
}

}  // namespace

SortieSplit split_into_sorties(const SplitProblem& problem) {
  const std::size_t count = problem.capture_point.size();
  if (count == 0 || problem.pads.empty()) return {};
  BestSplits best(count);
  for (std::size_t first = 0; first < count; ++first) {
    if (best.time[first] == never) continue;
    for (std::uint32_t pad = 0; pad < problem.pads.size(); ++pad) {
      extend(problem, pad, first, best);
    }
  }
  SortieSplit split;
  if (best.time[count] == never) return split;
  for (std::size_t end = count; end > 0; end = best.last[end].first) {
    split.sorties.push_back(best.last[end]);
  }
  std::reverse(split.sorties.begin(), split.sorties.end());
  split.time = best.time[count];
  split.time_bound = min_time(problem);
  return split;
}

}  // namespace skycap::flight
