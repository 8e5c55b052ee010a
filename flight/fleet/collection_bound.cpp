#include "flight/fleet/collection_bound.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace skycap::flight {
namespace {

/// Number of time steps of the makespan in the ascent and in the final evaluation.
constexpr std::size_t coarse_steps = 400, max_fine_steps = 4000;
constexpr double max_work = 4e9;  ///< Maximum number of dynamic programming steps in the ascent.
/// Maximum number of dynamic programming steps in the final evaluation.
constexpr double max_fine_work = 5e8;
constexpr std::size_t max_rounds = 600;
/// Iterations without a better bound before the step length is halved.
constexpr std::size_t patience = 15;
constexpr double sum_rounding = 1e-9;      ///< Rounding tolerance of prize sums.
constexpr double nothing = -1.0;           ///< Prize where no tour exists.
constexpr std::uint32_t pad = UINT32_MAX;  ///< Predecessor of the first waypoint.

/// Best tours to a waypoint at a time: the best overall, and the best with a different predecessor.
struct Best {
  double prize[2] = {nothing, nothing};
  std::uint32_t from[2] = {pad, pad};

  void offer(double offered, std::uint32_t capture_point) {
    if (offered <= prize[1]) return;
    if (capture_point == from[0] && prize[0] > nothing) {
      prize[0] = std::max(prize[0], offered);
    } else if (offered > prize[0]) {
      prize[1] = prize[0], from[1] = from[0];
      prize[0] = offered, from[0] = capture_point;
    } else {
      prize[1] = offered, from[1] = capture_point;
    }
  }
  /// Returns the index of the tour that may continue to `next`, without turning back at once.
  std::size_t on_to(std::uint32_t next) const { return from[0] == next && next != pad ? 1 : 0; }
};

/// Prizes that one vehicle collects in tours of a limited number of time steps.
class Collector {
 public:
  Collector(const FleetVehicle& vehicle, double step, std::size_t steps)
      : count_(vehicle.count()), steps_(steps) {
    const auto in_steps = [&](double time) {
      return static_cast<std::size_t>(std::min(std::floor(time / step), 1.0 + double(steps)));
    };
    for (std::size_t i = 0; i < count_; ++i) {
      out_.push_back(in_steps(vehicle.out[i].time + vehicle.capture_point[i].time));
      back_.push_back(in_steps(vehicle.back[i].time));
    }
    for (std::uint32_t j = 0; j < count_; ++j) {
      for (std::uint32_t i = 0; i < count_; ++i) {
        // Direct or via the pad, so that several sorties of a vehicle count as one tour.
        const double by_pad = vehicle.back[i].time + vehicle.out[j].time;
        const double leg = std::min(vehicle.leg(i, j).time, by_pad) + vehicle.capture_point[j].time;
        legs_.push_back(std::max(std::size_t{1}, in_steps(leg)));
      }
    }
  }

  /// Returns M(t) for t = 0, 1, ... steps with these prizes.
  const std::vector<double>& collect(const std::vector<double>& prizes) {
    best_.assign((steps_ + 1) * count_, {});
    max_profit_.assign(steps_ + 1, 0.0);
    ends_.assign(steps_ + 1, {pad, 0});
    for (std::size_t t = 0; t <= steps_; ++t) {
      for (std::uint32_t j = 0; j < count_; ++j) reach(t, j, prizes[j]);
      if (t > 0 && max_profit_[t - 1] > max_profit_[t])
        max_profit_[t] = max_profit_[t - 1], ends_[t] = ends_[t - 1];
    }
    return max_profit_;
  }

  /// Adds the number of visits of the best tour of up to t steps to each waypoint, for the latest
  /// prizes.
  void count_visits(std::size_t t, std::vector<double>& visits) const {
    auto [capture_point, time] = ends_[t];
    std::uint32_t next = pad;
    while (capture_point != pad) {
      visits[capture_point] += 1.0;
      const Best& best = at(time, capture_point);
      const std::uint32_t from = best.from[best.on_to(next)];
      if (from == pad) break;
      time -= legs_[capture_point * count_ + from];
      next = capture_point;
      capture_point = from;
    }
  }

 private:
  struct End {
    std::uint32_t capture_point;
    std::size_t time;
  };

  const Best& at(std::size_t t, std::uint32_t capture_point) const {
    return best_[t * count_ + capture_point];
  }

  void reach(std::size_t t, std::uint32_t j, double prize) {
    if (t + back_[j] > steps_) return;
    Best best;
    if (t == out_[j]) best.offer(prize, pad);
    const std::size_t* legs = &legs_[j * count_];
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (i == j || legs[i] > t) continue;
      const Best& before = at(t - legs[i], i);
      const double collected = before.prize[before.on_to(j)];
      if (collected > nothing) best.offer(collected + prize, i);
    }
    best_[t * count_ + j] = best;
    const std::size_t end = t + back_[j];
    if (best.prize[0] > max_profit_[end]) max_profit_[end] = best.prize[0], ends_[end] = {j, t};
  }

  std::size_t count_, steps_;
  std::vector<std::size_t> out_, back_;  ///< Including the stop at the waypoint, in steps.
  std::vector<std::size_t> legs_;        ///< To waypoint j from waypoint i at [j * count + i].
  std::vector<Best> best_;
  std::vector<double> max_profit_;
  std::vector<End> ends_;  ///< Last waypoint of the best tour, with its time.
};

/// All vehicles at one time step length.
class Fleet {
 public:
  Fleet(const FleetProblem& lower_bound, double makespan, std::size_t steps)
      : step_(makespan / static_cast<double>(steps)), steps_(steps) {
    for (const FleetVehicle& vehicle : lower_bound.vehicles)
      collectors_.emplace_back(vehicle, step_, steps);
  }

  /// Returns the first time at which all prizes can be collected.
  double bound(const std::vector<double>& prizes) {
    std::vector<double> sum(steps_ + 1, 0.0);
    for (Collector& collector : collectors_) {
      const std::vector<double>& max = collector.collect(prizes);
      for (std::size_t t = 0; t <= steps_; ++t) sum[t] += max[t];
    }
    const double all = std::accumulate(prizes.begin(), prizes.end(), 0.0);
    first_ = 0;
    while (first_ < steps_ && sum[first_] < all - sum_rounding) ++first_;
    return static_cast<double>(first_) * step_;
  }

  /// Returns the visits of the best tours at the latest bound, per waypoint.
  std::vector<double> visits(std::size_t count) const {
    std::vector<double> visits(count, 0.0);
    for (const Collector& collector : collectors_) collector.count_visits(first_, visits);
    return visits;
  }

 private:
  double step_;
  std::size_t steps_, first_ = 0;
  std::vector<Collector> collectors_;
};

/// Returns the prizes after a step against the visits. Prizes are non-negative and add up to 1.
std::vector<double> moved(const std::vector<double>& prizes, const std::vector<double>& visits,
                          double length) {
  double squared = 0.0, sum = 0.0;
  for (const double count : visits) squared += (1.0 - count) * (1.0 - count);
  // Each waypoint is visited once, so the tours are a partition.
  if (squared == 0.0) return prizes;
  std::vector<double> after;
  for (std::size_t i = 0; i < prizes.size(); ++i) {
    after.push_back(std::max(0.0, prizes[i] + length * (1.0 - visits[i]) / squared));
    sum += after.back();
  }
  if (!(sum > 0.0)) return prizes;
  for (double& prize : after) prize /= sum;
  return after;
}

}  // namespace

double collection_bound(const FleetProblem& lower_bound, double makespan) {
  const std::size_t count = lower_bound.count(), vehicles = lower_bound.vehicles.size();
  if (count == 0 || !(makespan > 0.0)) return 0.0;
  const auto step = static_cast<double>(count * count * vehicles);
  const auto rounds =
      std::min(max_rounds, static_cast<std::size_t>(max_work / (step * double(coarse_steps))));
  if (rounds == 0) return 0.0;
  std::vector<double> prizes(count, 1.0 / static_cast<double>(count)), best = prizes;
  double bound = 0.0, length = 0.3 / static_cast<double>(vehicles);
  std::size_t since = 0;
  Fleet coarse(lower_bound, makespan, coarse_steps);
  for (std::size_t i = 0; i < rounds; ++i) {
    if (const double found = coarse.bound(prizes); found > bound) {
      bound = found, best = prizes, since = 0;
    } else if (++since == patience) {
      length *= 0.5, since = 0, prizes = best;
      coarse.bound(prizes);
    }
    prizes = moved(prizes, coarse.visits(count), length);
  }
  const auto fine_steps =
      std::clamp(static_cast<std::size_t>(max_fine_work / step), coarse_steps, max_fine_steps);
  return std::max(bound, Fleet(lower_bound, makespan, fine_steps).bound(best));
}

}  // namespace skycap::flight
