#include "survey/photo/cover_bound.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace skycap::survey::photo {
namespace {

/// Lagrangian relaxation of the covering problem. Samples that are not covered have no price.
class Relaxation {
 public:
  Relaxation(const PhotoChoiceProblem& problem, std::span<const std::uint32_t> samples,
             int observations)
      : problem_(problem), samples_(samples), observations_(observations) {
    reduced_.resize(problem.candidates.size());
  }

  /// Returns the bound for these prices of all samples. Stores the selected candidates in `taken`.
  double solve(const std::vector<double>& prices, std::vector<std::uint32_t>& taken) {
    std::ranges::fill(reduced_, 1.0);
    double bound = 0.0;
    for (const std::uint32_t s : samples_) {
      if (prices[s] == 0.0) continue;
      bound += observations_ * prices[s];
      for (const std::uint32_t c : problem_.observers[s]) reduced_[c] -= prices[s];
    }
    taken.clear();
    for (std::uint32_t c = 0; c < reduced_.size(); ++c) {
      if (reduced_[c] >= 0.0) continue;
      bound += reduced_[c];
      taken.push_back(c);
    }
    return bound;
  }

 private:
  const PhotoChoiceProblem& problem_;
  std::span<const std::uint32_t> samples_;
  int observations_;
  std::vector<double> reduced_;  ///< Reduced cost of each candidate.
};

}  // namespace

CoverBound cover_bound(const PhotoChoiceProblem& problem, std::span<const std::uint32_t> samples,
                       int observations, std::size_t upper_bound) {
  constexpr int rounds = 3000, patience = 20;
  constexpr double weight_of_new = 0.1, growth = 1.1, shrinkage = 0.7, min_step = 1e-4;
  const std::size_t all = problem.samples->size();
  std::size_t max_observers = 0;
  for (const std::uint32_t s : samples) {
    max_observers = std::max(max_observers, problem.observers[s].size());
  }
  if (max_observers == 0) return {};
  Relaxation relaxation(problem, samples, observations);
  std::vector<double> centre(all, 0.0), prices(all, 0.0), covered(all, 0.0), now(all, 0.0);
  for (const std::uint32_t s : samples) centre[s] = 1.0 / static_cast<double>(max_observers);
  std::vector<std::uint32_t> taken;
  const auto cover = [&](std::vector<double>& observers) {
    std::ranges::fill(observers, 0.0);
    for (const std::uint32_t c : taken) {
      for (const std::uint32_t s : problem.observed[c]) observers[s] += 1.0;
    }
  };
  double best = relaxation.solve(centre, taken), step = 1.0;
  cover(covered);
  int idle = 0;
  for (int round = 0; round < rounds && step > min_step; ++round) {
    const auto slack = [&](std::uint32_t s) {
      const double value = observations - covered[s];
      return centre[s] == 0.0 && value < 0.0 ? 0.0 : value;
    };
    double squared = 0.0;
    for (const std::uint32_t s : samples) squared += slack(s) * slack(s);
    if (squared < 1e-12) break;
    const double length = step * (static_cast<double>(upper_bound) - best) / squared;
    for (const std::uint32_t s : samples) {
      prices[s] = std::max(0.0, centre[s] + length * slack(s));
    }
    const double bound = relaxation.solve(prices, taken);
    cover(now);
    for (const std::uint32_t s : samples) {
      covered[s] += weight_of_new * (now[s] - covered[s]);
    }
    if (bound > best) {
      if (bound > best * (1.0 + 1e-5)) idle = 0;
      best = bound;
      centre.swap(prices);
      step = std::min(2.0, step * growth);
    } else if (++idle >= patience) {
      step *= shrinkage;
      idle = 0;
    }
  }
  constexpr double rounding = 1e-6;
  return {best, static_cast<std::size_t>(std::ceil(std::max(0.0, best - rounding)))};
}

}  // namespace skycap::survey::photo
