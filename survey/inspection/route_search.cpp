#include "survey/inspection/route_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace skycap::survey::inspection {
namespace {

using Eigen::Vector3d;
using geometry::RandomNumbers;

constexpr double view_interval = 0.4;       // between samples of the view [s]
constexpr double clearance_interval = 0.1;  // between samples of position [s]
constexpr double penalty_interval = 0.2;    // flight time that one penalty stands for [s]
constexpr double end_temperature = 0.03;    // [s]
constexpr double max_weight = 8.0;          // of an unseen point [s]
constexpr std::size_t weight_moves = 500;

/// What one interval of the polygon adds to the route.
struct IntervalSights {
  std::vector<PointSight> seen;
  double penalty = 0.0;
};

/// Penalties of the intervals of a route for violated limits.
class Penalties {
 public:
  Penalties(const ReachableSpace& space, const MotionLimits& limits)
      : space_(space), limits_(limits) {}

  /// Returns the penalty of a prepared interval [s]. Stops early above `limit`.
  double of_interval(const IntervalCurve& curve, double limit) const {
    double penalty = 0.0;
    const std::vector<double>& jumps = curve.jumps();
    // The acceleration is linear between jumps of the jerk, so that its norm is largest at one.
    double before = curve.acceleration(jumps.front()).head<3>().norm();
    for (std::size_t i = 1; i < jumps.size(); ++i) {
      const double after = curve.acceleration(jumps[i]).head<3>().norm();
      const double length = jumps[i] - jumps[i - 1];
      const double weight = std::max(length, clearance_interval) / penalty_interval;
      penalty += weight * acceleration_cost(std::max(before, after));
      constexpr double min_length = 1e-6;  // jumps at the same time, but for rounding
      if (length > min_length) {
        const double middle = 0.5 * (jumps[i] + jumps[i - 1]);
        penalty += weight * jerk_cost(curve.jerk(middle).head<3>().norm());
      }
      before = after;
    }
    if (penalty > limit) return penalty;
    const double share = clearance_interval / penalty_interval;
    const auto samples =
        static_cast<std::size_t>((curve.end() - curve.begin()) / clearance_interval) + 1;
    for (std::size_t i = 0; i <= samples; ++i) {
      const double time =
          std::min(curve.begin() + clearance_interval * static_cast<double>(i), curve.end());
      penalty += share * position_cost(curve.position(time).head<3>());
      if (penalty > limit) return penalty;
    }
    return penalty;
  }

 private:
  double acceleration_cost(double acceleration) const {
    constexpr double free_share = 0.985, cost = 4.0;
    return cost * std::max(0.0, acceleration / limits_.acceleration - free_share);
  }
  double jerk_cost(double jerk) const {
    constexpr double free_share = 0.99, cost = 3.0;
    return cost * std::max(0.0, jerk / limits_.jerk - free_share);
  }
  double position_cost(const Vector3d& position) const {
    constexpr double per_metre = 30.0, violated = 0.2;
    double cost = 0.0;
    const double missing = space_.required_distance() - space_.distance(position);
    if (missing > 0.0) cost += per_metre * missing + violated;
    const double outside =
        std::max(space_.min_height() - position.z(), position.z() - space_.max_height());
    if (outside > 0.0) cost += per_metre * outside + violated;
    return cost;
  }

  const ReachableSpace& space_;
  const MotionLimits& limits_;
};

/// Number of samples in which each point is seen by each rule, and the number of unseen points.
class SightCounts {
 public:
  SightCounts(std::size_t targets, int min_views,
              const PerRule<std::vector<std::uint8_t>>& more_views)
      : targets_(targets), min_views_(static_cast<std::uint16_t>(min_views)) {
    std::uint8_t most = 0;
    for (const auto& more : more_views) {
      for (const std::uint8_t views : more) most = std::max(most, views);
    }
    // Counts begin lower where more views are needed, so that one threshold serves all points.
    min_views_ = static_cast<std::uint16_t>(min_views_ + most);
    for (std::size_t rule = 0; rule < sight_rules; ++rule) {
      counts_[rule].assign(targets, most);
      for (std::size_t i = 0; i < std::min(targets, more_views[rule].size()); ++i) {
        counts_[rule][i] = static_cast<std::uint16_t>(most - more_views[rule][i]);
      }
      unseen_[rule] = targets;
    }
  }
  void add(const std::vector<PointSight>& seen) {
    for (const PointSight sight : seen) {
      for (std::size_t rule = 0; rule < sight.level(); ++rule) {
        if (++counts_[rule][sight.point()] == min_views_) --unseen_[rule];
      }
    }
  }
  void remove(const std::vector<PointSight>& seen) {
    for (const PointSight sight : seen) {
      for (std::size_t rule = 0; rule < sight.level(); ++rule) {
        if (counts_[rule][sight.point()]-- == min_views_) ++unseen_[rule];
      }
    }
  }
  const PerRule<std::size_t>& unseen() const { return unseen_; }
  bool is_seen(std::size_t rule, std::size_t point) const {
    return counts_[rule][point] >= min_views_;
  }
  std::size_t targets() const { return targets_; }

 private:
  std::size_t targets_;
  std::uint16_t min_views_;
  PerRule<std::vector<std::uint16_t>> counts_;
  PerRule<std::size_t> unseen_{};
};

double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

Vector3d normal_vector(RandomNumbers& random, double sigma) {
  Vector3d result;
  for (int i = 0; i < 3; ++i) result[i] = sigma * random.normal();
  return result;
}

Vector3d unit_vector(RandomNumbers& random) {
  for (;;) {
    Vector3d result;
    for (int i = 0; i < 3; ++i) result[i] = random.between(-1.0, 1.0);
    const double squared = result.squaredNorm();
    constexpr double min_squared = 1e-4;
    if (squared <= 1.0 && squared > min_squared) return result / std::sqrt(squared);
  }
}

/// Changes of a polygon, drawn at random. Each returns nothing if it does not apply.
class RouteMoves {
 public:
  RouteMoves(const ReachableSpace& space, const SightCells& cells, const SearchOptions& options,
             RandomNumbers& random)
      : space_(space), cells_(cells), options_(options), random_(random) {}

  /// Step sizes shrink with the used share of the budget.
  void set_progress(double share) { scale_ = 1.0 - 0.75 * share; }

  std::optional<std::vector<Vertex>> draw(const std::vector<Vertex>& route,
                                          const SightCounts& counts,
                                          const std::vector<std::uint8_t>& attainable) {
    const double kind = random_.uniform();
    if (kind < 0.22) return shift_one(route);
    if (kind < 0.40) return turn_one(route);
    if (kind < 0.46) return shift_and_turn(route);
    if (kind < 0.62) return bend(route);
    if (kind < 0.74) return erase(route);
    if (kind < 0.82) return insert_middle(route);
    if (kind < 0.92) return repair(route, counts, attainable);
    if (kind < 0.95) return reverse_stretch(route);
    if (kind < 0.98) return move_chain(route);
    return change_delay(route);
  }

 private:
  using Route = std::vector<Vertex>;
  using Change = std::optional<Route>;

  std::size_t pick(std::size_t count) { return static_cast<std::size_t>(random_() % count); }

  void shift(Vertex& vertex) {
    const double sigma = scale_ * random_.between(0.3, 2.0);
    vertex.position += normal_vector(random_, sigma);
  }
  void turn(Vertex& vertex, double yaw, double pitch) const {
    vertex.yaw = wrapped(vertex.yaw + yaw);
    vertex.pitch = std::clamp(vertex.pitch + pitch, options_.pitch.min, options_.pitch.max);
  }
  void turn(Vertex& vertex) {
    const double sigma = scale_ * random_.between(5.0, 40.0) * geometry::radians_per_degree;
    const double yaw = sigma * random_.normal();
    constexpr double pitch_share = 0.7;
    const double pitch = pitch_share * sigma * random_.normal();
    turn(vertex, yaw, pitch);
  }

  Change shift_one(Route route) {
    shift(route[pick(route.size())]);
    return route;
  }
  Change turn_one(Route route) {
    turn(route[pick(route.size())]);
    return route;
  }
  Change shift_and_turn(Route route) {
    Vertex& vertex = route[pick(route.size())];
    shift(vertex);
    turn(vertex);
    return route;
  }

  Change bend(Route route) {
    const std::size_t count = 2 + pick(5);
    if (route.size() < count) return std::nullopt;
    const std::size_t begin = pick(route.size() - count + 1);
    const double kind = random_.uniform();
    Vector3d offset = Vector3d::Zero();
    double yaw = 0.0, pitch = 0.0;
    if (kind < 0.7) {
      const double sigma = scale_ * random_.between(0.2, 1.5);
      offset = normal_vector(random_, sigma);
    }
    if (kind > 0.4) {
      const double sigma = scale_ * random_.between(5.0, 25.0) * geometry::radians_per_degree;
      yaw = sigma * random_.normal();
      pitch = sigma * random_.normal();
    }
    for (std::size_t k = 1; k <= count; ++k) {
      const double weight =
          std::sin(std::numbers::pi * static_cast<double>(k) / static_cast<double>(count + 1));
      Vertex& vertex = route[begin + k - 1];
      vertex.position += weight * offset;
      turn(vertex, weight * yaw, weight * pitch);
    }
    return route;
  }

  Change erase(Route route) {
    const bool erases_one = random_.uniform() < 0.6;
    const std::size_t count = erases_one ? 1 : 2 + pick(3);
    if (route.size() < count + 2) return std::nullopt;
    const std::size_t begin = pick(route.size() - count + 1);
    route.erase(route.begin() + static_cast<std::ptrdiff_t>(begin),
                route.begin() + static_cast<std::ptrdiff_t>(begin + count));
    if (random_.uniform() < 0.4) {
      if (begin > 0) shift(route[begin - 1]);
      if (begin < route.size()) shift(route[begin]);
    }
    return route;
  }

  Change insert_middle(Route route) {
    if (route.size() < 2) return std::nullopt;
    const std::size_t leg = pick(route.size() - 1);
    const Vertex& from = route[leg];
    const Vertex& to = route[leg + 1];
    Vertex middle;
    middle.position = 0.5 * (from.position + to.position);
    middle.yaw = wrapped(from.yaw + 0.5 * wrapped(to.yaw - from.yaw));
    middle.pitch = 0.5 * (from.pitch + to.pitch);
    shift(middle);
    turn(middle);
    route.insert(route.begin() + static_cast<std::ptrdiff_t>(leg + 1), middle);
    return route;
  }

  /// Returns the leg before which a chain costs least: 0 is before the first vertex.
  static std::size_t cheapest_gap(const Route& route, const Vector3d& first, const Vector3d& last) {
    std::size_t best = 0;
    double min_detour = std::numeric_limits<double>::infinity();
    for (std::size_t gap = 0; gap <= route.size(); ++gap) {
      double detour = 0.0;
      if (gap > 0) detour += (first - route[gap - 1].position).norm();
      if (gap < route.size()) detour += (route[gap].position - last).norm();
      if (gap > 0 && gap < route.size()) {
        detour -= (route[gap].position - route[gap - 1].position).norm();
      }
      if (detour >= min_detour) continue;
      min_detour = detour;
      best = gap;
    }
    return best;
  }

  /// Draws a position from which a point is seen.
  std::optional<Vector3d> draw_viewpoint(std::uint32_t point, std::uint32_t level) {
    constexpr int tries = 20;
    const double range = cells_.camera().range;
    const Vector3d at = cells_.cloud().points[point].cast<double>();
    for (int i = 0; i < tries; ++i) {
      const Vector3d direction = unit_vector(random_);
      const double distance = random_.between(options_distance(), range);
      const Vector3d position = at + distance * direction;
      if (!space_.is_reachable(position)) continue;
      if (cells_.level(position, point) >= level) return position;
    }
    return std::nullopt;
  }
  double options_distance() const {
    return std::min(space_.required_distance(), 0.9 * cells_.camera().range);
  }

  /// Draws one of the rules that the goal requires.
  std::size_t draw_rule() {
    std::vector<std::size_t> required;
    for (std::size_t i = 0; i < sight_rules; ++i) {
      if (options_.goal.shares[i] > 0.0) required.push_back(i);
    }
    if (required.empty()) return 0;
    return required.size() == 1 ? required[0] : required[pick(required.size())];
  }

  /// Draws an attainable point that is not seen. The last few of many points are not found by
  /// trying, so all are searched from the last one tried.
  std::optional<std::uint32_t> draw_unseen(std::size_t rule, const SightCounts& counts,
                                           const std::vector<std::uint8_t>& attainable) {
    constexpr int tries = 200;
    const auto is_wanted = [&](std::size_t point) {
      return attainable[point] > rule && !counts.is_seen(rule, point);
    };
    std::size_t point = 0;
    for (int i = 0; i < tries; ++i) {
      point = pick(counts.targets());
      if (is_wanted(point)) return static_cast<std::uint32_t>(point);
    }
    for (std::size_t i = 1; i < counts.targets(); ++i) {
      const std::size_t other = (point + i) % counts.targets();
      if (is_wanted(other)) return static_cast<std::uint32_t>(other);
    }
    return std::nullopt;
  }

  Change repair(Route route, const SightCounts& counts,
                const std::vector<std::uint8_t>& attainable) {
    const std::size_t rule = draw_rule();
    const std::optional<std::uint32_t> target = draw_unseen(rule, counts, attainable);
    if (!target) return std::nullopt;
    const std::optional<Vector3d> position =
        draw_viewpoint(*target, static_cast<std::uint32_t>(rule + 1));
    if (!position) return std::nullopt;
    const Vector3d line = cells_.cloud().points[*target].cast<double>() - *position;
    constexpr double noise = 0.2;
    Vertex vertex;
    vertex.position = *position;
    const double yaw_noise = noise * random_.normal();
    const double pitch_noise = noise * random_.normal();
    turn(vertex, std::atan2(line.y(), line.x()) + yaw_noise,
         std::atan2(line.z(), line.head<2>().norm()) + pitch_noise);
    const std::size_t gap = cheapest_gap(route, *position, *position);
    if (random_.uniform() < 0.5 || gap >= route.size()) {
      route.insert(route.begin() + static_cast<std::ptrdiff_t>(gap), vertex);
    } else {
      route[gap] = vertex;
    }
    return route;
  }

  Change reverse_stretch(Route route) {
    if (route.size() < 4) return std::nullopt;
    const std::size_t i = pick(route.size()), j = pick(route.size());
    const std::size_t begin = std::min(i, j), end = std::max(i, j);
    if (end < begin + 2) return std::nullopt;
    double longer = 0.0;
    const auto gap = [&](std::size_t a, std::size_t b) {
      return (route[a].position - route[b].position).norm();
    };
    if (begin > 0) longer += gap(begin - 1, end) - gap(begin - 1, begin);
    if (end + 1 < route.size()) longer += gap(begin, end + 1) - gap(end, end + 1);
    constexpr double max_longer = 8.0;
    if (longer > max_longer) return std::nullopt;
    std::reverse(route.begin() + static_cast<std::ptrdiff_t>(begin),
                 route.begin() + static_cast<std::ptrdiff_t>(end + 1));
    return route;
  }

  Change move_chain(Route route) {
    const std::size_t count = 1 + pick(8);
    if (route.size() < count + 3) return std::nullopt;
    const std::size_t begin = pick(route.size() - count + 1);
    Route chain(route.begin() + static_cast<std::ptrdiff_t>(begin),
                route.begin() + static_cast<std::ptrdiff_t>(begin + count));
    route.erase(route.begin() + static_cast<std::ptrdiff_t>(begin),
                route.begin() + static_cast<std::ptrdiff_t>(begin + count));
    if (random_.uniform() < 0.5) std::ranges::reverse(chain);
    const std::size_t gap = cheapest_gap(route, chain.front().position, chain.back().position);
    route.insert(route.begin() + static_cast<std::ptrdiff_t>(gap), chain.begin(), chain.end());
    return route;
  }

  Change change_delay(Route route) {
    Vertex& vertex = route[pick(route.size())];
    vertex.delay = std::max(0.0, vertex.delay + scale_ * random_.normal());
    constexpr double negligible = 0.05;
    if (vertex.delay < negligible) vertex.delay = 0.0;
    return route;
  }

  const ReachableSpace& space_;
  const SightCells& cells_;
  const SearchOptions& options_;
  RandomNumbers& random_;
  double scale_ = 1.0;
};

/// Annealing state: the current route, its intervals and counts.
class Annealing {
 public:
  Annealing(const ReachableSpace& space, const SightCells& cells,
            const std::vector<std::uint8_t>& attainable, const SearchOptions& options)
      : cells_(cells),
        attainable_(attainable),
        options_(options),
        smoothing_(make_smoothing(options.limits)),
        penalties_(space, options.limits),
        min_level_(options.goal.min_level()) {}

  const std::vector<Vertex>& route() const { return route_; }
  const SightCounts& counts() const { return *counts_; }
  double duration() const { return flight_duration(durations_, smoothing_); }

  /// Sets the route and the number of targets, and evaluates all of it.
  void start(std::vector<Vertex> route, std::size_t targets) {
    route_ = std::move(route);
    durations_ = leg_durations(route_, smoothing_);
    counts_.emplace(targets, options_.goal.min_views, options_.more_views);
    allowed_ = options_.goal.allowed_unseen(attainable_, targets);
    intervals_.assign(route_.size() + 1, {});
    for (std::size_t i = 0; i < intervals_.size(); ++i) {
      curve_.set(route_, durations_, smoothing_, i);
      intervals_[i].penalty =
          penalties_.of_interval(curve_, std::numeric_limits<double>::infinity());
      add_views(intervals_[i]);
      counts_->add(intervals_[i].seen);
    }
    set_min_weights();
    update_cost();
  }

  /// Scales the weights of unseen points for another number of targets.
  void scale_weights(double factor) {
    for (double& weight : weights_) weight *= factor;
    update_cost();
  }
  PerRule<double> weights() const { return weights_; }
  void set_weights(const PerRule<double>& weights) {
    weights_ = weights;
    update_cost();
  }

  /// Raises the weights of rules whose goal is missed, and lowers the others.
  void adapt_weights() {
    constexpr double up = 1.03, down = 0.97;
    for (std::size_t rule = 0; rule < sight_rules; ++rule) {
      const bool is_missed = counts_->unseen()[rule] > allowed_[rule];
      weights_[rule] = std::clamp(weights_[rule] * (is_missed ? up : down), min_weight(),
                                  std::max(max_weight, min_weight()));
    }
    update_cost();
  }

  /// Replaces the route by `next` if its cost is at most `margin` above the current cost.
  bool try_route(std::vector<Vertex> next, double margin) {
    const double limit = cost_ + margin;
    std::vector<double> durations = leg_durations(next, smoothing_);
    const double duration = flight_duration(durations, smoothing_);
    if (duration > limit) return false;
    const Span span = changed_span(next, durations);
    double sum = duration;
    for (std::size_t i = 0; i < span.begin; ++i) sum += intervals_[i].penalty;
    for (std::size_t i = intervals_.size() - span.kept_end; i < intervals_.size(); ++i) {
      sum += intervals_[i].penalty;
    }
    const std::size_t end = next.size() + 1 - span.kept_end;
    std::vector<IntervalSights> changed(end - span.begin);
    for (std::size_t i = span.begin; i < end; ++i) {
      curve_.set(next, durations, smoothing_, i);
      IntervalSights& interval = changed[i - span.begin];
      interval.penalty = penalties_.of_interval(curve_, limit - sum);
      sum += interval.penalty;
      if (sum > limit) return false;
    }
    ++evaluated_;
    for (std::size_t i = span.begin; i < end; ++i) {
      curve_.set(next, durations, smoothing_, i);
      add_views(changed[i - span.begin]);
    }
    const std::size_t old_end = intervals_.size() - span.kept_end;
    for (std::size_t i = span.begin; i < old_end; ++i) counts_->remove(intervals_[i].seen);
    for (const IntervalSights& interval : changed) counts_->add(interval.seen);
    const double cost = sum + unseen_cost();
    if (cost > limit) {
      for (const IntervalSights& interval : changed) counts_->remove(interval.seen);
      for (std::size_t i = span.begin; i < old_end; ++i) counts_->add(intervals_[i].seen);
      return false;
    }
    const auto first = intervals_.begin() + static_cast<std::ptrdiff_t>(span.begin);
    const auto last = intervals_.begin() + static_cast<std::ptrdiff_t>(old_end);
    const auto at = intervals_.erase(first, last);
    intervals_.insert(at, std::make_move_iterator(changed.begin()),
                      std::make_move_iterator(changed.end()));
    route_ = std::move(next);
    durations_ = std::move(durations);
    cost_ = cost;
    return true;
  }

  double penalty() const {
    double sum = 0.0;
    for (const IntervalSights& interval : intervals_) sum += interval.penalty;
    return sum;
  }
  /// Returns the number of points above the goal, over all rules.
  std::size_t missing() const {
    std::size_t sum = 0;
    for (std::size_t rule = 0; rule < sight_rules; ++rule) {
      const std::size_t unseen = counts_->unseen()[rule];
      if (unseen > allowed_[rule]) sum += unseen - allowed_[rule];
    }
    return sum;
  }
  SearchedRoute result() const { return {route_, duration(), counts_->unseen(), missing()}; }
  std::size_t evaluated() const { return evaluated_; }

 private:
  struct Span {
    std::size_t begin = 0;     // intervals that are kept at the beginning
    std::size_t kept_end = 0;  // and at the end
  };

  /// Intervals of the current route whose curve does not change with `next`.
  Span changed_span(const std::vector<Vertex>& next, const std::vector<double>& durations) const {
    const double reach = smoothing_.reach();
    const std::size_t shared = std::min(route_.size(), next.size());
    std::size_t same = 0;
    while (same < shared && route_[same] == next[same]) ++same;
    std::size_t same_end = 0;
    while (same_end < shared - same &&
           route_[route_.size() - 1 - same_end] == next[next.size() - 1 - same_end]) {
      ++same_end;
    }
    Span span;
    if (same > 0) {
      double known = 0.0;  // time of the last common vertex
      for (std::size_t i = 0; i + 1 < same; ++i) known += durations[i];
      double end = 0.0;  // of the interval
      while (span.begin < same && end + reach <= known) {
        end += durations[span.begin];
        ++span.begin;
      }
    }
    if (same_end > 0) {
      double known = 0.0;
      for (std::size_t i = 0; i + 1 < same_end; ++i) known += durations[durations.size() - 1 - i];
      double end = 0.0;
      while (span.kept_end < same_end && end + reach <= known) {
        end += durations[durations.size() - 1 - span.kept_end];
        ++span.kept_end;
      }
    }
    return span;
  }

  void add_views(IntervalSights& interval) const {
    interval.seen.clear();
    for (int i = 0;; ++i) {
      const double time = curve_.begin() + view_interval * i;
      if (time >= curve_.end()) break;
      const Coordinates at = curve_.position(time);
      cells_.add_view(at.head<3>(), at[3], at[4], counts_->targets(), min_level_, interval.seen);
    }
  }

  double min_weight() const {
    constexpr double per_target = 300.0;
    return std::min(max_weight, std::max(options_.min_unseen_weight,
                                         per_target / static_cast<double>(counts_->targets())));
  }
  void set_min_weights() { weights_.fill(min_weight()); }
  double unseen_cost() const {
    double sum = 0.0;
    for (std::size_t rule = 0; rule < sight_rules; ++rule) {
      const std::size_t unseen = counts_->unseen()[rule];
      if (unseen > allowed_[rule]) {
        sum += weights_[rule] * static_cast<double>(unseen - allowed_[rule]);
      }
    }
    return sum;
  }
  void update_cost() { cost_ = duration() + penalty() + unseen_cost(); }

  const SightCells& cells_;
  const std::vector<std::uint8_t>& attainable_;
  const SearchOptions& options_;
  Smoothing smoothing_;
  Penalties penalties_;
  std::uint32_t min_level_;
  IntervalCurve curve_;
  std::vector<Vertex> route_;
  std::vector<double> durations_;
  std::vector<IntervalSights> intervals_;
  std::optional<SightCounts> counts_;
  PerRule<std::size_t> allowed_{};
  PerRule<double> weights_{};
  double cost_ = 0.0;
  std::size_t evaluated_ = 0;
};

}  // namespace

std::uint32_t CoverageGoal::min_level() const {
  for (std::size_t rule = 0; rule < sight_rules; ++rule) {
    if (shares[rule] > 0.0) return static_cast<std::uint32_t>(rule + 1);
  }
  return static_cast<std::uint32_t>(sight_rules);
}

PerRule<std::size_t> CoverageGoal::allowed_unseen(std::span<const std::uint8_t> attainable,
                                                  std::size_t targets) const {
  PerRule<std::size_t> allowed{};
  for (std::size_t rule = 0; rule < sight_rules; ++rule) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < targets; ++i) count += attainable[i] > rule ? 1 : 0;
    const auto required =
        static_cast<std::size_t>(std::ceil(shares[rule] * static_cast<double>(count)));
    allowed[rule] = targets - required;
  }
  return allowed;
}

double route_penalty(const ReachableSpace& space, std::span<const Vertex> vertices,
                     const MotionLimits& limits) {
  const Smoothing smoothing = make_smoothing(limits);
  const std::vector<double> durations = leg_durations(vertices, smoothing);
  const Penalties penalties(space, limits);
  IntervalCurve curve;
  double sum = 0.0;
  for (std::size_t i = 0; i <= vertices.size(); ++i) {
    curve.set(vertices, durations, smoothing, i);
    sum += penalties.of_interval(curve, std::numeric_limits<double>::infinity());
  }
  return sum;
}

SearchResult search_route(const ReachableSpace& space, const SightCells& cells,
                          const ViewCandidates& candidates, std::vector<Vertex> first,
                          const SearchOptions& options, RandomNumbers& random,
                          const std::stop_token& stop, const SearchProgress& progress) {
  const std::size_t points = cells.cloud().size();
  const std::size_t targets = std::clamp<std::size_t>(options.first_phase_targets, 1, points);
  Annealing annealing(space, cells, candidates.attainable, options);
  RouteMoves moves(space, cells, options, random);
  SearchResult result;
  annealing.start(std::move(first), targets);
  result.first_duration = annealing.duration();
  const auto budget = static_cast<double>(std::max<std::size_t>(options.moves, 1));
  const auto switch_move = static_cast<std::size_t>(budget * (1.0 - options.last_phase_share));
  bool is_last_phase = false;
  for (std::size_t move = 0; move < options.moves && !stop.stop_requested(); ++move) {
    const double used = static_cast<double>(move) / budget;
    if (!is_last_phase && move >= switch_move) {
      is_last_phase = true;
      const PerRule<double> weights = annealing.weights();
      annealing.start(annealing.route(), points);
      annealing.set_weights(weights);
      annealing.scale_weights(static_cast<double>(targets) / static_cast<double>(points));
    }
    if (move % weight_moves == 0) {
      if (move > 0) annealing.adapt_weights();
      if (progress) progress(used, annealing.duration());
    }
    moves.set_progress(used);
    std::optional<std::vector<Vertex>> next =
        moves.draw(annealing.route(), annealing.counts(), candidates.attainable);
    const double temperature =
        options.start_temperature * std::pow(end_temperature / options.start_temperature, used);
    const double draw = 1.0 - random.uniform();  // in (0, 1]
    if (!next) continue;
    if (!annealing.try_route(std::move(*next), -temperature * std::log(draw))) continue;
    ++result.accepted;
    if (!is_last_phase || annealing.penalty() > 0.0) continue;
    const std::pair rank(annealing.missing(), annealing.duration());
    if (result.improvements.empty() ||
        rank < std::pair(result.improvements.back().missing, result.improvements.back().duration)) {
      result.improvements.push_back(annealing.result());
    }
  }
  result.last = annealing.result();
  result.evaluated = annealing.evaluated();
  return result;
}

}  // namespace skycap::survey::inspection
