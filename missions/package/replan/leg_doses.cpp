#include "missions/package/replan/leg_doses.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace skycap::missions::package {
namespace {

/// Maximum number of cached paths, each of some ten thousand bytes; the cache is then cleared.
constexpr std::size_t max_cached_legs = 1U << 13;

/// Path between two stops, with the lower number first. Null (number zero) is the home position.
struct StopPair {
  const Stop *first, *second;

  std::uint64_t key() const {
    return std::uint64_t{first == nullptr ? 0 : first->number} << 32 |
           std::uint64_t{second == nullptr ? 0 : second->number};
  }
};

/// Returns the paths of a tour sorted by key.
std::vector<StopPair> to_stop_pairs(const Stops& stops) {
  std::vector<StopPair> stop_pairs;
  for (std::size_t i = 0; i <= stops.size() && !stops.empty(); ++i) {
    const Stop* a = i == 0 ? nullptr : stops[i - 1].get();
    const Stop* b = i == stops.size() ? nullptr : stops[i].get();
    const bool is_turned = b == nullptr || (a != nullptr && b->number < a->number);
    stop_pairs.push_back(is_turned ? StopPair{b, a} : StopPair{a, b});
  }
  std::ranges::sort(stop_pairs, {}, &StopPair::key);
  return stop_pairs;
}

std::vector<StopPair> without(const std::vector<StopPair>& stop_pairs,
                              const std::vector<StopPair>& others) {
  std::vector<StopPair> rest;
  std::ranges::set_difference(stop_pairs, others, std::back_inserter(rest), {}, &StopPair::key,
                              &StopPair::key);
  return rest;
}

}  // namespace

void LegDoses::change(ObservationSum& sum, const Stops& from, const Stops& to) {
  if (!problem_.leg_observations) return;
  const std::vector<StopPair> before = to_stop_pairs(from), after = to_stop_pairs(to);
  for (const StopPair& stop_pair : without(before, after))
    sum.remove(strengths(stop_pair.first, stop_pair.second));
  for (const StopPair& stop_pair : without(after, before))
    sum.add(strengths(stop_pair.first, stop_pair.second));
}

const std::vector<ObservationStrength>& LegDoses::strengths(const Stop* a, const Stop* b) {
  const std::uint64_t key = StopPair{a, b}.key();
  if (const auto known = strengths_.find(key); known != strengths_.end()) return known->second;
  if (strengths_.size() > max_cached_legs) strengths_.clear();
  const auto* from = a == nullptr ? nullptr : &a->view;
  const auto* to = b == nullptr ? nullptr : &b->view;
  return strengths_[key] = observation_strengths(problem_.leg_observations(from, to));
}

}  // namespace skycap::missions::package
