#include "flight/route/tour.h"

#include <algorithm>
#include <limits>

namespace skycap::flight {
namespace {

/// Minimum improvement, above rounding. Otherwise moves could cycle.
constexpr double min_gain = 1e-9;
constexpr std::size_t longest_chain = 3;  ///< Maximum number of nodes that Or-opt moves together.
constexpr int ascent_steps = 300;         ///< Steps of the subgradient ascent for the lower bound.

class TourPlanner {
 public:
  TourPlanner(std::uint32_t count, const std::function<double(std::uint32_t, std::uint32_t)>& cost)
      : count_(count), costs_(std::size_t{count} * count) {
    for (std::uint32_t a = 0; a < count; ++a) {
      for (std::uint32_t b = 0; b < a; ++b) {
        costs_[std::size_t{a} * count + b] = costs_[std::size_t{b} * count + a] = cost(a, b);
      }
    }
  }

  Tour plan() {
    start_nearest_neighbour();
    while (two_opt() || or_opt()) {
    }
    Tour tour;
    tour.cost = tour_cost();
    tour.order.assign(tour_.begin() + 1, tour_.end());
    tour.lower_bound = std::min(tour.cost, lower_bound(tour.cost));
    return tour;
  }

 private:
  double cost(std::uint32_t a, std::uint32_t b) const {
    return costs_[std::size_t{a} * count_ + b];
  }
  std::uint32_t at(std::size_t i) const { return tour_[i % tour_.size()]; }

  double tour_cost() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < tour_.size(); ++i) sum += cost(at(i), at(i + 1));
    return sum;
  }

  void start_nearest_neighbour() {
    tour_ = {0};
    std::vector<bool> is_visited(count_, false);
    is_visited[0] = true;
    while (tour_.size() < count_) {
      std::uint32_t nearest = 0;
      double min = std::numeric_limits<double>::infinity();
      for (std::uint32_t next = 1; next < count_; ++next) {
        if (is_visited[next] || cost(tour_.back(), next) >= min) continue;
        min = cost(tour_.back(), next);
        nearest = next;
      }
      is_visited[nearest] = true;
      tour_.push_back(nearest);
    }
  }

  /// Reverses sections while that shortens the tour. Returns true if it did.
  bool two_opt() {
    bool has_improved = false;
    for (std::size_t i = 0; i + 2 < tour_.size(); ++i) {
      for (std::size_t j = i + 2; j < tour_.size(); ++j) {
        const double gain = cost(at(i), at(i + 1)) + cost(at(j), at(j + 1)) - cost(at(i), at(j)) -
                            cost(at(i + 1), at(j + 1));
        if (gain <= min_gain) continue;
        std::reverse(tour_.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                     tour_.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        has_improved = true;
      }
    }
    return has_improved;
  }

  /// Moves a chain of up to three nodes, in either direction. Node 0 remains first.
  bool or_opt() {
    bool has_improved = false;
    for (std::size_t size = 1; size <= longest_chain; ++size) {
      for (std::size_t i = 1; i + size <= tour_.size(); ++i) {
        has_improved = move_chain(i, size) || has_improved;
      }
    }
    return has_improved;
  }

  bool move_chain(std::size_t first, std::size_t size) {
    const std::uint32_t head = tour_[first], tail = tour_[first + size - 1];
    const double removed = cost(at(first - 1), head) + cost(tail, at(first + size)) -
                           cost(at(first - 1), at(first + size));
    for (std::size_t j = 0; j < tour_.size(); ++j) {  // Between nodes j and j + 1.
      if (j + 1 >= first && j < first + size) continue;
      const double base = cost(at(j), at(j + 1));
      const double ahead = cost(at(j), head) + cost(tail, at(j + 1)) - base;
      const double turned = cost(at(j), tail) + cost(head, at(j + 1)) - base;
      if (removed - std::min(ahead, turned) <= min_gain) continue;
      std::vector<std::uint32_t> chain(tour_.begin() + static_cast<std::ptrdiff_t>(first),
                                       tour_.begin() + static_cast<std::ptrdiff_t>(first + size));
      if (turned < ahead) std::reverse(chain.begin(), chain.end());
      tour_.erase(tour_.begin() + static_cast<std::ptrdiff_t>(first),
                  tour_.begin() + static_cast<std::ptrdiff_t>(first + size));
      const std::size_t after = j < first ? j : j - size;
      tour_.insert(tour_.begin() + static_cast<std::ptrdiff_t>(after) + 1, chain.begin(),
                   chain.end());
      return true;
    }
    return false;
  }

  /// Returns the bound of Held & Karp (1971): the minimum 1-tree with costs that are raised at
  /// nodes of high degree and lowered at leaves. Polyak steps use the tour's cost as target.
  double lower_bound(double upper) const {
    if (count_ < 3) return upper;
    std::vector<double> price(count_, 0.0);
    double best = 0.0, scale = 1.0;
    for (int step = 0; step < ascent_steps; ++step) {
      std::vector<int> degree(count_, 0);
      const double bound = one_tree(price, degree);
      if (bound > best) {
        best = bound;
      } else {
        scale *= 0.98;
      }
      double squared_excess = 0.0;
      for (const int d : degree) squared_excess += (d - 2) * (d - 2);
      if (squared_excess == 0.0) break;  // The 1-tree is a tour.
      const double length = scale * (upper - bound) / squared_excess;
      for (std::uint32_t v = 0; v < count_; ++v) price[v] += length * (degree[v] - 2);
    }
    return best;
  }

  /// Returns the cost of a minimum spanning tree of nodes 1 .. count-1 (Prim) plus the two cheapest
  /// edges of node 0.
  double one_tree(const std::vector<double>& price, std::vector<int>& degree) const {
    const auto priced = [&](std::uint32_t a, std::uint32_t b) {
      return cost(a, b) + price[a] + price[b];
    };
    std::vector<double> min(count_, std::numeric_limits<double>::infinity());
    std::vector<std::uint32_t> parent(count_, 1);
    std::vector<bool> is_in_tree(count_, false);
    double sum = 0.0;
    min[1] = 0.0;
    for (std::uint32_t added = 1; added < count_; ++added) {
      std::uint32_t next = 0;
      for (std::uint32_t v = 1; v < count_; ++v) {
        if (!is_in_tree[v] && (next == 0 || min[v] < min[next])) next = v;
      }
      is_in_tree[next] = true;
      sum += min[next];
      if (next != 1) ++degree[next], ++degree[parent[next]];
      for (std::uint32_t v = 1; v < count_; ++v) {
        if (is_in_tree[v] || priced(next, v) >= min[v]) continue;
        min[v] = priced(next, v);
        parent[v] = next;
      }
    }
    std::uint32_t first = 1, second = 2;
    if (priced(0, second) < priced(0, first)) std::swap(first, second);
    for (std::uint32_t v = 3; v < count_; ++v) {
      if (priced(0, v) < priced(0, first)) {
        second = first, first = v;
      } else if (priced(0, v) < priced(0, second)) {
        second = v;
      }
    }
    for (const std::uint32_t end : {first, second}) {
      sum += priced(0, end);
      ++degree[0], ++degree[end];
    }
    for (const double p : price) sum -= 2.0 * p;
    return sum;
  }

  std::uint32_t count_;
  std::vector<double> costs_;
  std::vector<std::uint32_t> tour_;
};

}  // namespace

Tour plan_tour(std::uint32_t count,
               const std::function<double(std::uint32_t, std::uint32_t)>& cost) {
  if (count < 2) return {};
  return TourPlanner(count, cost).plan();
}

}  // namespace skycap::flight
