#include "flight/fleet/timetable.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

namespace skycap::flight {
namespace {

constexpr double later_by = 1.0;                ///< what a start is put off by [s]
constexpr std::size_t most_in_every_order = 5;  ///< vehicles: 120 sequences

/// Gives starts, one sequence of vehicles after another.
class Scheduler {
 public:
  Scheduler(const std::vector<FleetSortie>& sorties, std::size_t vehicles,
            const SeparationRule& rule)
      : sorties_(sorties), rule_(rule), of_(vehicles), work_(vehicles, 0.0) {
    for (std::size_t i = 0; i < sorties.size(); ++i) {
      of_[sorties[i].vehicle].push_back(i);
      durations_.push_back(std::ceil(duration(sorties[i].script)));
      work_[sorties[i].vehicle] += duration(sorties[i].script);
    }
    for (std::vector<std::size_t>& own : of_) {
      std::ranges::stable_sort(own, {}, [&](std::size_t i) { return sorties_[i].number; });
    }
  }

  Timetable best() {
    std::vector<std::size_t> turns(of_.size());
    std::iota(turns.begin(), turns.end(), std::size_t{0});
    std::ranges::stable_sort(turns, std::greater(), [&](std::size_t v) { return work_[v]; });
    Timetable best = by_turns(turns, std::numeric_limits<double>::infinity()).value();
    if (turns.size() > most_in_every_order) return with_delay(best);
    std::vector<std::size_t> rank = turns, places(turns.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    while (std::next_permutation(places.begin(), places.end())) {
      for (std::size_t i = 0; i < places.size(); ++i) rank[i] = turns[places[i]];
      if (auto other = by_turns(rank, best.makespan)) best = *std::move(other);
    }
    return with_delay(best);
  }

 private:
  /// The vehicles in turn, a sortie each, until all have their starts; nothing if that is not
  /// sooner done than `below`.
  std::optional<Timetable> by_turns(const std::vector<std::size_t>& turns, double below) {
    Timetable table{.starts = std::vector<double>(sorties_.size(), 0.0)};
    std::vector<std::size_t> placed;
    std::vector<double> ready(of_.size(), 0.0);
    for (std::size_t number = 0; placed.size() < sorties_.size(); ++number) {
      for (const std::size_t v : turns) {
        if (number >= of_[v].size()) continue;
        const std::size_t i = of_[v][number];
        table.starts[i] = first_start(i, ready[v], placed, table.starts);
        ready[v] = table.starts[i] + durations_[i];
        placed.push_back(i);
        const double landing = table.starts[i] + duration(sorties_[i].script);
        table.makespan = std::max(table.makespan, landing);
        if (table.makespan >= below) return std::nullopt;
      }
    }
    return table;
  }

  double first_start(std::size_t i, double ready, const std::vector<std::size_t>& placed,
                     const std::vector<double>& starts) {
    double last = ready;  // from then on it is alone in the air, early or late
    for (const std::size_t j : placed) {
      last = std::max(last, starts[j] + durations_[j] + std::ceil(2.0 * rule_.tolerance) + 1.0);
    }
    for (double start = ready; start < last; start += later_by) {
      const bool is_free = std::ranges::all_of(placed, [&](std::size_t j) {
        return sorties_[i].vehicle == sorties_[j].vehicle || is_apart(i, start, j, starts[j]);
      });
      if (is_free) return start;
    }
    return last;
  }

  /// Depends on the difference of both starts alone, and is asked again and again.
  bool is_apart(std::size_t i, double start, std::size_t j, double other) {
    const auto key = std::make_tuple(i, j, start - other);
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    const auto flight = [&](std::size_t k, double at) {
      return TimedFlight{sorties_[k].script, sorties_[k].jerk, at};
    };
    const bool is_proven = !too_near(flight(i, start - other), flight(j, 0.0), rule_);
    return known_[key] = is_proven;
  }

  Timetable with_delay(Timetable table) const {
    table.delay = table.makespan - *std::ranges::max_element(work_);
    return table;
  }

  const std::vector<FleetSortie>& sorties_;
  SeparationRule rule_;
  std::vector<std::vector<std::size_t>> of_;  ///< sorties by vehicle
  std::vector<double> durations_;             ///< in whole seconds, rounded up
  std::vector<double> work_;                  ///< by vehicle [s]
  std::map<std::tuple<std::size_t, std::size_t, double>, bool> known_;
};

}  // namespace

Timetable timetable(const std::vector<FleetSortie>& sorties, std::size_t vehicles,
                    const SeparationRule& rule) {
  if (sorties.empty()) return {};
  return Scheduler(sorties, vehicles, rule).best();
}

std::optional<SortiePair> first_conflict(const std::vector<TimedFlight>& flights,
                                         const std::vector<std::size_t>& vehicle_of,
                                         const SeparationRule& rule) {
  for (std::size_t i = 0; i < flights.size(); ++i) {
    for (std::size_t j = i + 1; j < flights.size(); ++j) {
      if (vehicle_of[i] == vehicle_of[j]) continue;
      if (const auto encounter = too_near(flights[i], flights[j], rule)) {
        return SortiePair{i, j, *encounter};
      }
    }
  }
  return std::nullopt;
}

}  // namespace skycap::flight
