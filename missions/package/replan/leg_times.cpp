#include "missions/package/replan/leg_times.h"

namespace skycap::missions::package {
namespace {

/// Estimated factor and additional time [s] of a path around an obstacle: longer length, and stops
/// at one or two corners.
constexpr double blocked_share = 1.15, blocked_time = 4.0;

/// Maximum number of cached legs; the cache is then cleared.
constexpr std::size_t max_legs = 1U << 16;

}  // namespace

/// Calls `visit(leg, from, to)` for each leg until it returns false.
template <typename Visit>
void LegTimes::for_each_leg(const Stops& stops, Visit visit) {
  if (stops.empty()) return;
  if (legs_.size() > max_legs) legs_.clear();
  for (std::size_t i = 0; i <= stops.size(); ++i) {
    const Stop* from = i == 0 ? nullptr : stops[i - 1].get();
    const Stop* to = i == stops.size() ? nullptr : stops[i].get();
    const std::uint64_t ends = std::uint64_t{from == nullptr ? 0 : from->number} << 32 |
                               std::uint64_t{to == nullptr ? 0 : to->number};
    const auto* from_view = from == nullptr ? nullptr : &from->view;
    const auto* to_view = to == nullptr ? nullptr : &to->view;
    if (!visit(legs_[ends], from_view, to_view)) return;
  }
}

double LegTimes::min(const Stops& stops) {
  double sum = static_cast<double>(stops.size()) * problem_.time_per_view + bends(stops);
  for_each_leg(stops, [&](Leg& leg, const auto* from, const auto* to) {
    if (leg.straight < 0.0) leg.straight = problem_.straight_time(from, to);
    sum += leg.is_blocked ? blocked_share * leg.straight + blocked_time : leg.straight;
    return true;
  });
  return sum;
}

double LegTimes::bends(const Stops& stops) const {
  if (!problem_.bend_time) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    sum += problem_.bend_time(i == 0 ? nullptr : &stops[i - 1]->view, stops[i]->view,
                              i + 1 == stops.size() ? nullptr : &stops[i + 1]->view);
  }
  return sum;
}

bool LegTimes::ask_next(const Stops& stops) {
  bool has_asked = false;
  for_each_leg(stops, [&](Leg& leg, const auto* from, const auto* to) {
    if (leg.is_asked) return true;
    leg.is_asked = has_asked = true;
    leg.is_blocked = !problem_.is_free(from, to);
    return false;
  });
  return has_asked;
}

double LegTimes::verified_time(const Stops& stops) {
  while (ask_next(stops)) {
  }
  for_each_leg(stops, [&](Leg& leg, const auto* from, const auto* to) {
    if (!leg.is_verified && !leg.is_blocked) leg.is_blocked = !problem_.has_returns(from, to);
    leg.is_verified = true;
    return true;
  });
  return min(stops);
}

}  // namespace skycap::missions::package
