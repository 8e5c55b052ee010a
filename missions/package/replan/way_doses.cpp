#include "missions/package/replan/way_doses.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace skycap::missions::package {
namespace {

/// Maximum number of cached paths, each of some ten thousand bytes; the cache is then cleared.
constexpr std::size_t most_ways = 1U << 13;

/// Path between two stops, with the lower number first. Null (number zero) is the home position.
struct StopWay {
  const Stop *first, *second;

  std::uint64_t key() const {
    return std::uint64_t{first == nullptr ? 0 : first->number} << 32 |
           std::uint64_t{second == nullptr ? 0 : second->number};
  }
};

/// Returns the paths of a tour sorted by key.
std::vector<StopWay> ways_of(const Stops& stops) {
  std::vector<StopWay> ways;
  for (std::size_t i = 0; i <= stops.size() && !stops.empty(); ++i) {
    const Stop* a = i == 0 ? nullptr : stops[i - 1].get();
    const Stop* b = i == stops.size() ? nullptr : stops[i].get();
    const bool is_turned = b == nullptr || (a != nullptr && b->number < a->number);
    ways.push_back(is_turned ? StopWay{b, a} : StopWay{a, b});
  }
  std::ranges::sort(ways, {}, &StopWay::key);
  return ways;
}

std::vector<StopWay> without(const std::vector<StopWay>& ways, const std::vector<StopWay>& others) {
  std::vector<StopWay> rest;
  std::ranges::set_difference(ways, others, std::back_inserter(rest), {}, &StopWay::key,
                              &StopWay::key);
  return rest;
}

}  // namespace

void WayDoses::change(DoseSum& sum, const Stops& from, const Stops& to) {
  if (!problem_.way_looks) return;
  const std::vector<StopWay> before = ways_of(from), after = ways_of(to);
  for (const StopWay& way : without(before, after)) sum.remove(doses(way.first, way.second));
  for (const StopWay& way : without(after, before)) sum.add(doses(way.first, way.second));
}

const std::vector<Dose>& WayDoses::doses(const Stop* a, const Stop* b) {
  const std::uint64_t key = StopWay{a, b}.key();
  if (const auto known = doses_.find(key); known != doses_.end()) return known->second;
  if (doses_.size() > most_ways) doses_.clear();
  const auto* from = a == nullptr ? nullptr : &a->view;
  const auto* to = b == nullptr ? nullptr : &b->view;
  return doses_[key] = doses_of(problem_.way_looks(from, to));
}

}  // namespace skycap::missions::package
