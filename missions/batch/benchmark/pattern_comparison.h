/// Comparison of planners with standard flight patterns: coverage at equal effort, and effort at
/// equal coverage. Effort is the flight time, or the path length of surveys without a vehicle.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "missions/batch/benchmark/benchmark_results.h"

namespace skycap::missions::batch {

/// Comparison of a planner with a pattern on one mission.
struct PatternComparison {
  std::string mission;
  std::string planner;
  std::string pattern;
  bool is_in_minutes = false;  ///< Unit of effort: minutes, otherwise metres.
  /// Mean final coverage, as a fraction of the surface, and mean effort of the whole survey.
  double planner_coverage = 0.0, planner_effort = 0.0;
  double pattern_coverage = 0.0, pattern_effort = 0.0;
  /// The same of the visible surface, if it is known.
  std::optional<double> planner_visible, pattern_visible;
  /// Mean coverage of the planner at the effort of the whole pattern.
  double coverage_at_equal_effort = 0.0;
  /// Coverage that both reach in every trial, and the mean effort until then. Nullopt if a trial
  /// of either does not reach it.
  double equal_coverage = 0.0;
  std::optional<double> planner_effort_at_equal_coverage, pattern_effort_at_equal_coverage;

  /// Returns how many times the effort of the planner the pattern requires for equal coverage.
  std::optional<double> ratio() const;
};

/// Compares each planner with each pattern of the same mission.
std::vector<PatternComparison> compare_with_patterns(const std::vector<BenchmarkCell>& cells);

/// Returns the section of the report. Empty if no cell is a pattern.
std::string pattern_markdown(const std::vector<BenchmarkCell>& cells);

}  // namespace skycap::missions::batch
