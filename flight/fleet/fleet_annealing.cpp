#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "flight/fleet/fleet_split.h"
#include "flight/fly_test/random_numbers.h"

namespace skycap::flight {
namespace {

using Order = std::vector<std::uint32_t>;

constexpr double never = std::numeric_limits<double>::infinity();
constexpr std::uint64_t seed = 1, stream_of_annealing = 6ULL << 32;
constexpr std::size_t moves_per_station = 6000, least_moves = 20'000;
constexpr double most_work = 6e7;  ///< stations in the orders that are tried, in all
constexpr std::size_t longest_chain = 4;
constexpr double first_temperature = 0.03, last_temperature = 0.0003;  ///< shares of the goal
/// What the other figure counts: a shorter flight of one vehicle makes room for the others'.
constexpr double share_of_other = 0.02;

std::ptrdiff_t offset(std::size_t index) { return static_cast<std::ptrdiff_t>(index); }

/// Simulated annealing (Kirkpatrick, Gelatt & Vecchi 1983) of orders of all vehicles.
class Annealing {
 public:
  Annealing(const FleetProblem& problem, FleetSplit split, FleetGoal goal)
      : problem_(problem),
        goal_(goal),
        parts_(std::move(split.parts)),
        best_(parts_),
        random_(seed, stream_of_annealing) {
    for (const FleetPart& part : parts_) times_.push_back(part.time);
    cost_ = best_cost_ = cost_of(times_);
  }

  FleetSplit run() {
    const double stations = static_cast<double>(std::max<std::size_t>(1, problem_.count()));
    const double wanted = std::max<double>(least_moves, moves_per_station * stations);
    const double most = most_work * static_cast<double>(parts_.size()) / stations;
    const auto moves = static_cast<std::size_t>(std::min(wanted, most));
    const double start = cost_;
    for (std::size_t i = 0; i < moves; ++i) {
      const double progress = static_cast<double>(i) / static_cast<double>(moves);
      temperature_ =
          start * first_temperature * std::pow(last_temperature / first_temperature, progress);
      change();
    }
    FleetSplit split{.parts = std::move(best_)};
    for (const FleetPart& part : split.parts) {
      split.makespan = std::max(split.makespan, part.time);
      split.flown += part.time;
    }
    return split;
  }

 private:
  double cost_of(const std::vector<double>& times) const {
    double makespan = 0.0, flown = 0.0;
    for (const double time : times) makespan = std::max(makespan, time), flown += time;
    const double mean = flown / static_cast<double>(times.size());
    return goal_ == FleetGoal::makespan ? makespan + share_of_other * mean
                                        : flown + share_of_other * makespan;
  }

  std::size_t draw(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(random_.uniform() * double(count)));
  }

  void change() {
    const std::size_t v = draw(parts_.size()), w = draw(parts_.size());
    const double kind = random_.uniform();
    if (kind < 0.25) {
      reverse_in(v);
    } else if (kind < 0.7 || v == w) {
      move_chain(v, w);
    } else if (kind < 0.85) {
      swap_stations(v, w);
    } else {
      swap_tails(v, w);
    }
  }

  void reverse_in(std::size_t v) {
    Order order = parts_[v].stations;
    if (order.size() < 2) return;
    std::size_t first = draw(order.size()), last = draw(order.size());
    if (first > last) std::swap(first, last);
    std::reverse(order.begin() + offset(first), order.begin() + offset(last + 1));
    decide(v, std::move(order), v, {});
  }

  void move_chain(std::size_t v, std::size_t w) {
    Order order = parts_[v].stations;
    if (order.empty()) return;
    const std::size_t first = draw(order.size());
    const std::size_t size = 1 + draw(std::min(longest_chain, order.size() - first));
    Order chain(order.begin() + offset(first), order.begin() + offset(first + size));
    order.erase(order.begin() + offset(first), order.begin() + offset(first + size));
    if (random_.uniform() < 0.5) std::ranges::reverse(chain);
    Order target = v == w ? order : parts_[w].stations;
    const std::size_t place = draw(target.size() + 1);
    target.insert(target.begin() + offset(place), chain.begin(), chain.end());
    if (v == w) {
      decide(v, std::move(target), v, {});
    } else {
      decide(v, std::move(order), w, std::move(target));
    }
  }

  void swap_stations(std::size_t v, std::size_t w) {
    Order one = parts_[v].stations, other = parts_[w].stations;
    if (one.empty() || other.empty()) return;
    const std::size_t i = draw(one.size()), j = draw(other.size());
    std::swap(one[i], other[j]);
    decide(v, std::move(one), w, std::move(other));
  }

  void swap_tails(std::size_t v, std::size_t w) {
    const Order &first = parts_[v].stations, &second = parts_[w].stations;
    const std::size_t i = draw(first.size() + 1), j = draw(second.size() + 1);
    Order one(first.begin(), first.begin() + offset(i));
    Order other(second.begin(), second.begin() + offset(j));
    one.insert(one.end(), second.begin() + offset(j), second.end());
    other.insert(other.end(), first.begin() + offset(i), first.end());
    decide(v, std::move(one), w, std::move(other));
  }

  /// Takes new orders of two vehicles (or of one, twice) if they are better, or by chance.
  void decide(std::size_t v, Order order, std::size_t w, Order other) {
    std::vector<double> times = times_;
    times[v] = part_time(problem_.vehicles[v], order);
    if (v != w) times[w] = part_time(problem_.vehicles[w], other);
    if (times[v] == never || times[w] == never) return;
    const double cost = cost_of(times);
    const double chance = random_.uniform();
    if (cost > cost_ && chance >= std::exp((cost_ - cost) / temperature_)) return;
    parts_[v] = {std::move(order), times[v]};
    if (v != w) parts_[w] = {std::move(other), times[w]};
    times_ = std::move(times);
    cost_ = cost;
    if (cost_ < best_cost_) best_cost_ = cost_, best_ = parts_;
  }

  const FleetProblem& problem_;
  FleetGoal goal_;
  std::vector<FleetPart> parts_, best_;
  std::vector<double> times_;  ///< of the parts
  double cost_ = 0.0, best_cost_ = 0.0, temperature_ = 1.0;
  RandomNumbers random_;
};

}  // namespace

FleetSplit annealed(const FleetProblem& problem, FleetSplit split, FleetGoal goal) {
  if (split.parts.empty()) return split;
  return Annealing(problem, std::move(split), goal).run();
}

}  // namespace skycap::flight
