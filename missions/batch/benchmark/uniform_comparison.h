/// Comparison of planners with surveys without planning: the planner `uniform` with different
/// numbers of views, each with its own set and tour.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "missions/batch/benchmark/benchmark_results.h"

namespace skycap::missions::batch {

/// Default numbers of views of the fixed sets in a benchmark.
inline constexpr std::size_t default_set_views[] = {5, 8, 10, 12, 15, 20, 25, 30, 40, 60, 100};

/// Result of a comparison of two means by the paired 95% confidence interval. Without an interval
/// that excludes zero, no difference is stated.
enum class Outcome { better, no_difference, worse };

/// Difference of a planner from another one over the seeds that both have.
struct PairedDifference {
  Statistic difference;  ///< planner minus other
  Outcome outcome = Outcome::no_difference;
};

/// Comparison of a planner with `uniform` on one mission.
struct UniformComparison {
  std::string mission;
  std::string planner;
  Statistic views, coverage, distance;  ///< of the planner
  std::size_t same_views = 0;           ///< mean number of views, rounded
  /// `uniform` with `same_views` views. Nullopt if it was not run with this number.
  std::optional<Statistic> uniform_coverage, uniform_distance;
  std::optional<PairedDifference> coverage_difference;  ///< more is better
  std::optional<PairedDifference> distance_difference;  ///< less is better
  /// Least tested number of views with which the mean coverage of `uniform` reaches that of the
  /// planner, and the length of its tour. Nullopt if no tested number does.
  std::optional<std::size_t> reaching_views;
  std::optional<Statistic> reaching_distance;
  std::size_t max_tested_views = 0;

  /// Returns whether the planner has more coverage or a shorter path than `uniform` with the same
  /// number of views, and is worse in neither.
  bool beats_uniform() const;
  /// Returns "beats uniform", "does not beat uniform", or which of both is better and worse.
  std::string verdict() const;
};

/// Compares each cell without a fixed set with the cells of `uniform` on the same mission, if there
/// are any.
std::vector<UniformComparison> compare_with_uniform(const std::vector<BenchmarkCell>& cells);

/// Returns the next number of views of a bisection: in the middle between the largest tested set
/// that does not reach the planner's coverage and the least that does. Nullopt: no number is left.
std::optional<std::size_t> next_set_views(const BenchmarkCell& cell,
                                          const std::vector<BenchmarkCell>& cells);

/// Returns the mean number of views, rounded and at least 1.
std::size_t compute_same_views(const BenchmarkCell& cell);

/// Returns the section of the report with both tables and the knowledge granted to fixed views.
/// Empty if no cell is a fixed set.
std::string uniform_markdown(const std::vector<BenchmarkCell>& cells);

}  // namespace skycap::missions::batch
