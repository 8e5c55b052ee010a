#include <algorithm>
#include <cmath>
#include <utility>

#include "flight/fleet/fleet_split.h"
#include "geometry/random_numbers.h"

namespace skycap::flight {
namespace {

using Order = std::vector<std::uint32_t>;

constexpr std::uint64_t seed = 1, annealing_stream = 6ULL << 32;
constexpr std::size_t moves_per_capture_point = 30'000, min_moves = 20'000;
constexpr double max_tried = 3e8;  ///< Total number of waypoints in all trial orders.
constexpr std::size_t longest_moved_chain = 4;
constexpr double first_temperature = 0.1, last_temperature = 0.0003;  ///< Relative to the goal.
constexpr double hopeless = -40.0;  ///< Exponent below which acceptance is practically impossible.
/// Weight of the other objective: a shorter flight of one vehicle gives freedom to the others.
constexpr double secondary_weight = 0.02;

std::ptrdiff_t signed_index(std::size_t index) { return static_cast<std::ptrdiff_t>(index); }

/// Times between nodes including the stops. The last node is the pad.
class Times {
 public:
  explicit Times(const FleetVehicle& vehicle)
      : pad_(static_cast<std::uint32_t>(vehicle.count())),
        times_((vehicle.count() + 1) * (vehicle.count() + 1), 0.0) {
    for (std::uint32_t j = 0; j < pad_; ++j) {
      const double rest = vehicle.capture_point[j].time;
      at(pad_, j) = vehicle.out[j].time + rest;
      at(j, pad_) = vehicle.back[j].time;
      for (std::uint32_t i = 0; i < pad_; ++i) at(i, j) = vehicle.leg(i, j).time + rest;
    }
  }

  /// Returns the time of one sortie, regardless of the battery.
  double of(const Order& order) const {
    double time = 0.0;
    std::uint32_t from = pad_;
    for (const std::uint32_t to : order) time += times_[index(from, to)], from = to;
    return time + times_[index(from, pad_)];
  }

 private:
  std::size_t index(std::uint32_t from, std::uint32_t to) const {
    return std::size_t{from} * (pad_ + 1) + to;
  }
  double& at(std::uint32_t from, std::uint32_t to) { return times_[index(from, to)]; }

  std::uint32_t pad_;
  std::vector<double> times_;
};

/// Simulated annealing (Kirkpatrick, Gelatt & Vecchi 1983) of the orders of all vehicles.
class Annealing {
 public:
  Annealing(const FleetProblem& problem, FleetSplit split, FleetGoal goal, std::uint64_t chain)
      : problem_(problem),
        goal_(goal),
        parts_(std::move(split.parts)),
        best_(parts_),
        random_(seed, annealing_stream + chain) {
    for (const FleetVehicle& vehicle : problem.vehicles) in_one_.emplace_back(vehicle);
    for (const FleetPart& part : parts_) times_.push_back(part.time);
    cost_ = best_cost_ = compute_cost(times_);
  }

  FleetSplit run() {
    const double capture_points = static_cast<double>(std::max<std::size_t>(1, problem_.count()));
    const double required_moves =
        std::max<double>(min_moves, moves_per_capture_point * capture_points);
    const double max = max_tried * static_cast<double>(parts_.size()) / capture_points;
    const auto moves = static_cast<std::size_t>(std::min(required_moves, max));
    temperature_ = cost_ * first_temperature;
    const double cooling =
        std::pow(last_temperature / first_temperature, 1.0 / static_cast<double>(moves));
    for (std::size_t i = 0; i < moves; ++i, temperature_ *= cooling) change();
    FleetSplit split{.parts = std::move(best_)};
    for (const FleetPart& part : split.parts) {
      split.makespan = std::max(split.makespan, part.time);
      split.total_flight_time += part.time;
    }
    return split;
  }

 private:
  double compute_cost(const std::vector<double>& times) const {
    double makespan = 0.0, total_flight_time = 0.0;
    for (const double time : times) makespan = std::max(makespan, time), total_flight_time += time;
    const double mean = total_flight_time / static_cast<double>(times.size());
    return goal_ == FleetGoal::makespan ? makespan + secondary_weight * mean
                                        : total_flight_time + secondary_weight * makespan;
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
      swap_capture_points(v, w);
    } else {
      swap_tails(v, w);
    }
  }

  void reverse_in(std::size_t v) {
    one_ = parts_[v].capture_points;
    if (one_.size() < 2) return;
    std::size_t first = draw(one_.size()), last = draw(one_.size());
    if (first > last) std::swap(first, last);
    std::reverse(one_.begin() + signed_index(first), one_.begin() + signed_index(last + 1));
    decide(v, v);
  }

  void move_chain(std::size_t v, std::size_t w) {
    one_ = parts_[v].capture_points;
    if (one_.empty()) return;
    const std::size_t first = draw(one_.size());
    const std::size_t size = 1 + draw(std::min(longest_moved_chain, one_.size() - first));
    const auto begin = one_.begin() + signed_index(first);
    chain_.assign(begin, begin + signed_index(size));
    one_.erase(begin, begin + signed_index(size));
    if (random_.uniform() < 0.5) std::ranges::reverse(chain_);
    if (v != w) other_ = parts_[w].capture_points;
    Order& target = v == w ? one_ : other_;
    const std::size_t index = draw(target.size() + 1);
    target.insert(target.begin() + signed_index(index), chain_.begin(), chain_.end());
    decide(v, w);
  }

  void swap_capture_points(std::size_t v, std::size_t w) {
    one_ = parts_[v].capture_points, other_ = parts_[w].capture_points;
    if (one_.empty() || other_.empty()) return;
    const std::size_t i = draw(one_.size()), j = draw(other_.size());
    std::swap(one_[i], other_[j]);
    decide(v, w);
  }

  void swap_tails(std::size_t v, std::size_t w) {
    const Order &first = parts_[v].capture_points, &second = parts_[w].capture_points;
    const auto i = signed_index(draw(first.size() + 1)), j = signed_index(draw(second.size() + 1));
    one_.assign(first.begin(), first.begin() + i);
    one_.insert(one_.end(), second.begin() + j, second.end());
    other_.assign(second.begin(), second.begin() + j);
    other_.insert(other_.end(), first.begin() + i, first.end());
    decide(v, w);
  }

  /// Accepts the new orders of two vehicles (or twice the same) if they are better, or randomly.
  void decide(std::size_t v, std::size_t w) {
    const double chance = random_.uniform();
    const auto is_good = [&] {
      const double cost = compute_cost(tried_);
      if (cost <= cost_) return true;
      const double exponent = (cost_ - cost) / temperature_;
      return exponent > hopeless && chance < std::exp(exponent);
    };
    tried_ = times_;
    // Most orders are rejected even with one unlimited battery, which is fast to compute.
    tried_[v] = in_one_[v].of(one_);
    if (v != w) tried_[w] = in_one_[w].of(other_);
    if (!is_good()) return;
    tried_[v] = part_time(problem_.vehicles[v], one_);
    if (v != w) tried_[w] = part_time(problem_.vehicles[w], other_);
    if (tried_[v] == never || tried_[w] == never || !is_good()) return;
    parts_[v].capture_points.swap(one_), parts_[v].time = tried_[v];
    if (v != w) parts_[w].capture_points.swap(other_), parts_[w].time = tried_[w];
    times_.swap(tried_);
    cost_ = compute_cost(times_);
    if (cost_ < best_cost_) best_cost_ = cost_, best_ = parts_;
  }

  const FleetProblem& problem_;
  FleetGoal goal_;
  std::vector<FleetPart> parts_, best_;
  std::vector<Times> in_one_;  ///< By vehicle.
  std::vector<double> times_;  ///< Times of the parts.
  Order one_, other_, chain_;  ///< Trial orders.
  std::vector<double> tried_;
  double cost_ = 0.0, best_cost_ = 0.0, temperature_ = 1.0;
  geometry::RandomNumbers random_;
};

}  // namespace

FleetSplit annealed(const FleetProblem& problem, FleetSplit split, FleetGoal goal,
                    std::uint64_t chain) {
  if (split.parts.empty()) return split;
  return Annealing(problem, std::move(split), goal, chain).run();
}

}  // namespace skycap::flight
