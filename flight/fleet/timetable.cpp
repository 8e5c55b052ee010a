#include "flight/fleet/timetable.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

namespace skycap::flight {
namespace {

constexpr double later_by = 1.0;  ///< Increment of a start time [s].
/// Number of vehicles up to which all sequences are tried: 120 for five.
constexpr std::size_t max_permuted = 5;

/// Assigns start times for one sequence of vehicles after another.
class Scheduler {
 public:
  Scheduler(const std::vector<FleetSortie>& sorties, std::size_t vehicles,
            const SeparationRule& rule)
      : sorties_(sorties), rule_(rule), variants_(vehicles) {
    for (std::size_t i = 0; i < sorties.size(); ++i) {
      std::vector<Variant>& variants = variants_[sorties[i].vehicle];
      variants.resize(std::max(variants.size(), sorties[i].variant + 1));
      variants[sorties[i].variant].sorties.push_back(i);
      variants[sorties[i].variant].work += duration(sorties[i].script);
      durations_.push_back(std::ceil(duration(sorties[i].script)));
    }
    for (std::vector<Variant>& variants : variants_) {
      for (Variant& variant : variants) {
        std::ranges::stable_sort(variant.sorties, {},
                                 [&](std::size_t i) { return sorties_[i].number; });
      }
    }
  }

  Timetable best() {
    std::vector<std::size_t> turns(variants_.size());
    std::iota(turns.begin(), turns.end(), std::size_t{0});
    std::ranges::stable_sort(turns, std::greater(), [&](std::size_t v) { return min_work(v); });
    Timetable best = by_turns(turns, std::numeric_limits<double>::infinity()).value();
    if (turns.size() > max_permuted) return with_delay(best);
    std::vector<std::size_t> rank = turns, ranks(turns.size());
    std::iota(ranks.begin(), ranks.end(), std::size_t{0});
    while (std::next_permutation(ranks.begin(), ranks.end())) {
      for (std::size_t i = 0; i < ranks.size(); ++i) rank[i] = turns[ranks[i]];
      if (auto other = by_turns(rank, best.makespan)) best = *std::move(other);
    }
    return with_delay(best);
  }

 private:
  /// Possible flight of a vehicle: its sorties in order.
  struct Variant {
    std::vector<std::size_t> sorties;
    double work = 0.0;  ///< Total duration [s].
  };

  double min_work(std::size_t vehicle) const {
    double min = variants_[vehicle].empty() ? 0.0 : std::numeric_limits<double>::infinity();
    for (const Variant& variant : variants_[vehicle]) min = std::min(min, variant.work);
    return min;
  }

  /// Schedules one sortie per vehicle in turn until all are scheduled. Returns std::nullopt unless
  /// the makespan is below `below`.
  std::optional<Timetable> by_turns(const std::vector<std::size_t>& turns, double below) {
    Timetable table{.starts = std::vector<double>(sorties_.size(), 0.0),
                    .variants = std::vector<std::size_t>(variants_.size(), 0)};
    std::vector<std::size_t> placed;
    std::vector<double> ready(variants_.size(), 0.0);
    bool is_done = false;
    for (std::size_t number = 0; !is_done; ++number) {
      is_done = true;
      for (const std::size_t v : turns) {
        if (variants_[v].empty()) continue;
        if (number == 0) table.variants[v] = soonest(v, placed, table.starts);
        const std::vector<std::size_t>& own = variants_[v][table.variants[v]].sorties;
        if (number >= own.size()) continue;
        is_done = false;
        const std::size_t i = own[number];
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

  /// Returns the variant that lands first if only its first start is delayed.
  std::size_t soonest(std::size_t vehicle, const std::vector<std::size_t>& placed,
                      const std::vector<double>& starts) {
    std::size_t best = 0;
    double min = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < variants_[vehicle].size(); ++k) {
      const Variant& variant = variants_[vehicle][k];
      const double start = first_start(variant.sorties.front(), 0.0, placed, starts);
      if (start + variant.work < min) min = start + variant.work, best = k;
    }
    return best;
  }

  double first_start(std::size_t i, double ready, const std::vector<std::size_t>& placed,
                     const std::vector<double>& starts) {
    double last = ready;  // After this time, it is alone in the air, whether early or late.
    for (const std::size_t j : placed) {
      last = std::max(last, starts[j] + durations_[j] + std::ceil(2.0 * rule_.tolerance) + 1.0);
    }
    double start = ready;
    while (start < last) {
      const bool is_free = std::ranges::all_of(placed, [&](std::size_t j) {
        return sorties_[i].vehicle == sorties_[j].vehicle || is_apart(i, start, j, starts[j]);
      });
      if (is_free) return start;
      start += later_by;
    }
    return last;
  }

  /// Returns true if two flights are separated. Cached, because it depends only on the difference
  /// of the start times.
  bool is_apart(std::size_t i, double start, std::size_t j, double other) {
    const auto key = std::make_tuple(i, j, start - other);
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    const auto flight = [&](std::size_t k, double at) {
      return TimedFlight{sorties_[k].script, sorties_[k].jerk, at};
    };
    const bool is_verified = !too_near(flight(i, start - other), flight(j, 0.0), rule_);
    return known_[key] = is_verified;
  }

  Timetable with_delay(Timetable table) const {
    double longest = 0.0;
    for (std::size_t v = 0; v < variants_.size(); ++v) longest = std::max(longest, min_work(v));
    table.delay = table.makespan - longest;
    return table;
  }

  const std::vector<FleetSortie>& sorties_;
  SeparationRule rule_;
  std::vector<std::vector<Variant>> variants_;  ///< By vehicle.
  std::vector<double> durations_;               ///< In whole seconds, rounded up.
  std::map<std::tuple<std::size_t, std::size_t, double>, bool> known_;
};

}  // namespace

Timetable timetable(const std::vector<FleetSortie>& sorties, std::size_t vehicles,
                    const SeparationRule& rule) {
  if (sorties.empty()) return {};
  return Scheduler(sorties, vehicles, rule).best();
}

}  // namespace skycap::flight
