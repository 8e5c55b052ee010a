#include <algorithm>
#include <utility>

#include "flight/fleet/fleet_split.h"

namespace skycap::flight {
namespace {

using Order = std::vector<std::uint32_t>;

/// Minimum improvement, above rounding. Otherwise moves could cycle.
constexpr double min_gain = 1e-9;
constexpr std::size_t longest_chain = 3;  ///< Maximum number of waypoints that are moved together.

std::ptrdiff_t offset(std::size_t index) { return static_cast<std::ptrdiff_t>(index); }

/// Local search on the orders: first improvement, in a fixed sequence.
class Exchange {
 public:
  Exchange(const FleetProblem& problem, FleetSplit split, FleetGoal goal)
      : problem_(problem), goal_(goal), scale_(std::max(split.makespan, 1e-9)) {
    for (FleetPart& part : split.parts) parts_.push_back(std::move(part));
  }

  FleetSplit run() {
    while (change_within() || change_between()) {
    }
    FleetSplit split{.parts = std::move(parts_)};
    for (const FleetPart& part : split.parts) {
      split.makespan = std::max(split.makespan, part.time);
      split.total_flight_time += part.time;
    }
    return split;
  }

 private:
  /// Returns the weight of a vehicle's time. The eighth power approximates the maximum, but also
  /// rewards shortening the other times, which gives freedom for moves.
  double weight(double time) const {
    if (goal_ == FleetGoal::total_flight_time) return time / scale_;
    const double share = time / scale_, square = share * share, fourth = square * square;
    return fourth * fourth;
  }

  double makespan_with(std::size_t v, double time, std::size_t w, double other) const {
    double max = std::max(time, other);
    for (std::size_t u = 0; u < parts_.size(); ++u) {
      if (u != v && u != w) max = std::max(max, parts_[u].time);
    }
    return max;
  }

  double makespan() const { return makespan_with(0, parts_[0].time, 0, parts_[0].time); }

  /// Accepts the new orders of two vehicles (or twice the same) if they are better. A greater
  /// makespan is never accepted if that is the goal.
  bool accept_if_better(std::size_t v, Order order, std::size_t w, Order other) {
    const double time = part_time(problem_.vehicles[v], order);
    if (time == never) return false;
    const double other_time = v == w ? time : part_time(problem_.vehicles[w], other);
    if (other_time == never) return false;
    double gain = weight(parts_[v].time) - weight(time);
    if (v != w) gain += weight(parts_[w].time) - weight(other_time);
    if (gain <= min_gain) return false;
    if (goal_ == FleetGoal::makespan && makespan_with(v, time, w, other_time) > makespan()) {
      return false;
    }
    parts_[v] = {std::move(order), time};
    if (v != w) parts_[w] = {std::move(other), other_time};
    return true;
  }

  bool change_within() {
    bool has_improved = false;
    for (std::size_t v = 0; v < parts_.size(); ++v) {
      while (reverse_in(v) || move_chain(v, v)) has_improved = true;
    }
    return has_improved;
  }

  bool change_between() {
    for (std::size_t v = 0; v < parts_.size(); ++v) {
      for (std::size_t w = 0; w < parts_.size(); ++w) {
        if (v == w) continue;
        if (move_chain(v, w)) return true;
        if (v < w && (swap_capture_points(v, w) || swap_tails(v, w))) return true;
      }
    }
    return false;
  }

  bool reverse_in(std::size_t v) {
    const Order order = parts_[v].capture_points;
    for (std::size_t i = 0; i + 1 < order.size(); ++i) {
      for (std::size_t j = i + 2; j <= order.size(); ++j) {
        Order turned = order;
        std::reverse(turned.begin() + offset(i), turned.begin() + offset(j));
        if (accept_if_better(v, std::move(turned), v, {})) return true;
      }
    }
    return false;
  }

  /// Moves a chain of one vehicle to a position in another's order or in its own, in either
  /// direction.
  bool move_chain(std::size_t v, std::size_t w) {
    const Order from = parts_[v].capture_points;
    for (std::size_t size = 1; size <= std::min(longest_chain, from.size()); ++size) {
      for (std::size_t i = 0; i + size <= from.size(); ++i) {
        Order chain(from.begin() + offset(i), from.begin() + offset(i + size));
        Order rest = from;
        rest.erase(rest.begin() + offset(i), rest.begin() + offset(i + size));
        if (put_chain(v, rest, w, chain)) return true;
        std::ranges::reverse(chain);
        if (size > 1 && put_chain(v, rest, w, chain)) return true;
      }
    }
    return false;
  }

  bool put_chain(std::size_t v, const Order& rest, std::size_t w, const Order& chain) {
    const Order& target = v == w ? rest : parts_[w].capture_points;
    for (std::size_t j = 0; j <= target.size(); ++j) {
      Order longer = target;
      longer.insert(longer.begin() + offset(j), chain.begin(), chain.end());
      const bool is_taken = v == w ? accept_if_better(v, std::move(longer), v, {})
                                   : accept_if_better(v, rest, w, std::move(longer));
      if (is_taken) return true;
    }
    return false;
  }

  bool swap_capture_points(std::size_t v, std::size_t w) {
    for (std::size_t i = 0; i < parts_[v].capture_points.size(); ++i) {
      for (std::size_t j = 0; j < parts_[w].capture_points.size(); ++j) {
        Order one = parts_[v].capture_points, other = parts_[w].capture_points;
        std::swap(one[i], other[j]);
        if (accept_if_better(v, std::move(one), w, std::move(other))) return true;
      }
    }
    return false;
  }

  /// Exchanges the tails of two orders, or joins the heads and the tails.
  bool swap_tails(std::size_t v, std::size_t w) {
    const Order first = parts_[v].capture_points, second = parts_[w].capture_points;
    for (std::size_t i = 0; i <= first.size(); ++i) {
      for (std::size_t j = 0; j <= second.size(); ++j) {
        Order one(first.begin(), first.begin() + offset(i));
        Order other(second.begin(), second.begin() + offset(j));
        Order heads = one, tails(first.rbegin(), first.rend() - offset(i));
        heads.insert(heads.end(), other.rbegin(), other.rend());
        tails.insert(tails.end(), second.begin() + offset(j), second.end());
        one.insert(one.end(), second.begin() + offset(j), second.end());
        other.insert(other.end(), first.begin() + offset(i), first.end());
        if (accept_if_better(v, std::move(one), w, std::move(other))) return true;
        if (accept_if_better(v, std::move(heads), w, std::move(tails))) return true;
      }
    }
    return false;
  }

  const FleetProblem& problem_;
  FleetGoal goal_;
  double scale_;
  std::vector<FleetPart> parts_;
};

}  // namespace

FleetSplit exchanged(const FleetProblem& problem, FleetSplit split, FleetGoal goal) {
  return Exchange(problem, std::move(split), goal).run();
}

}  // namespace skycap::flight
