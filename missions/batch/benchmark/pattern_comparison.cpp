#include "missions/batch/benchmark/pattern_comparison.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include <fmt/format.h>

#include "missions/batch/benchmark/markdown_table.h"
#include "missions/batch/benchmark/methods.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::batch {
namespace {

bool is_pattern(const BenchmarkCell& cell) {
  const auto name = survey::planner_called(cell.planner);
  return name && survey::pattern_of(*name);
}

bool is_flown(const BenchmarkCell& cell) {
  return std::ranges::all_of(cell.trials, [](const Trial& trial) { return trial.has_vehicle(); });
}

/// Returns the effort after each view: flight minutes, or metres.
std::vector<double> efforts_of(const Trial& trial, bool is_in_minutes) {
  if (!is_in_minutes) return trial.distance_after;
  constexpr double seconds_per_minute = 60.0;
  std::vector<double> minutes;
  for (const double seconds : trial.flight_time_after) {
    minutes.push_back(seconds / seconds_per_minute);
  }
  return minutes;
}

template <typename Figure>
double mean_over(const std::vector<Trial>& trials, Figure figure) {
  double sum = 0.0;
  for (const Trial& trial : trials) sum += figure(trial);
  return sum / static_cast<double>(trials.size());
}

double final_effort(const BenchmarkCell& cell, bool is_in_minutes) {
  return mean_over(cell.trials, [&](const Trial& trial) {
    const std::vector<double> efforts = efforts_of(trial, is_in_minutes);
    return efforts.empty() ? 0.0 : efforts.back();
  });
}

/// Returns the mean coverage that the trials have at an effort.
double coverage_at_effort(const BenchmarkCell& cell, bool is_in_minutes, double effort) {
  return mean_over(cell.trials, [&](const Trial& trial) {
    const std::vector<double> efforts = efforts_of(trial, is_in_minutes);
    double coverage = 0.0;
    for (std::size_t i = 0; i < efforts.size() && efforts[i] <= effort; ++i) {
      coverage = trial.coverage_after[i];
    }
    return coverage;
  });
}

/// Returns the mean effort until a coverage is reached, or nullopt if a trial does not reach it.
std::optional<double> effort_until(const BenchmarkCell& cell, bool is_in_minutes, double coverage) {
  double sum = 0.0;
  for (const Trial& trial : cell.trials) {
    const auto reached = std::ranges::find_if(trial.coverage_after, [&](double reached_coverage) {
      return reached_coverage >= coverage;
    });
    if (reached == trial.coverage_after.end()) return std::nullopt;
    sum += efforts_of(
        trial, is_in_minutes)[static_cast<std::size_t>(reached - trial.coverage_after.begin())];
  }
  return sum / static_cast<double>(cell.trials.size());
}

/// Returns the largest coverage that every trial of both cells reaches.
double common_coverage(const BenchmarkCell& a, const BenchmarkCell& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const BenchmarkCell* cell : {&a, &b}) {
    for (const Trial& trial : cell->trials) least = std::min(least, trial.coverage.all);
  }
  return least;
}

std::string percent_text(const std::optional<double>& coverage) {
  return coverage ? fmt::format("{:.1f}", 100.0 * *coverage) : "-";
}

/// Returns the mean coverage of the visible surface, or nullopt if a trial has none.
std::optional<double> visible_coverage(const BenchmarkCell& cell) {
  double sum = 0.0;
  for (const Trial& trial : cell.trials) {
    if (!trial.coverage.visible) return std::nullopt;
    sum += *trial.coverage.visible;
  }
  return sum / static_cast<double>(cell.trials.size());
}

std::string effort_text(const std::optional<double>& value, bool is_in_minutes) {
  if (!value) return "-";
  return is_in_minutes ? fmt::format("{:.1f}", *value) : fmt::format("{:.0f}", *value);
}

}  // namespace

std::optional<double> PatternComparison::ratio() const {
  if (!planner_effort_at_equal_coverage || !pattern_effort_at_equal_coverage ||
      *planner_effort_at_equal_coverage <= 0.0) {
    return std::nullopt;
  }
  return *pattern_effort_at_equal_coverage / *planner_effort_at_equal_coverage;
}

std::vector<PatternComparison> compare_with_patterns(const std::vector<BenchmarkCell>& cells) {
  std::vector<PatternComparison> comparisons;
  for (const BenchmarkCell& planner : cells) {
    if (is_pattern(planner) || planner.set_views || planner.trials.empty()) continue;
    for (const BenchmarkCell& pattern : cells) {
      if (!is_pattern(pattern) || pattern.mission != planner.mission || pattern.trials.empty()) {
        continue;
      }
      const bool is_in_minutes = is_flown(planner) && is_flown(pattern);
      PatternComparison comparison{.mission = planner.mission,
                                   .planner = planner.planner,
                                   .pattern = pattern.planner,
                                   .is_in_minutes = is_in_minutes};
      const auto final_coverage = [](const Trial& trial) { return trial.coverage.all; };
      comparison.planner_coverage = mean_over(planner.trials, final_coverage);
      comparison.pattern_coverage = mean_over(pattern.trials, final_coverage);
      comparison.planner_visible = visible_coverage(planner);
      comparison.pattern_visible = visible_coverage(pattern);
      comparison.planner_effort = final_effort(planner, is_in_minutes);
      comparison.pattern_effort = final_effort(pattern, is_in_minutes);
      comparison.coverage_at_equal_effort =
          coverage_at_effort(planner, is_in_minutes, comparison.pattern_effort);
      comparison.equal_coverage = common_coverage(planner, pattern);
      comparison.planner_effort_at_equal_coverage =
          effort_until(planner, is_in_minutes, comparison.equal_coverage);
      comparison.pattern_effort_at_equal_coverage =
          effort_until(pattern, is_in_minutes, comparison.equal_coverage);
      comparisons.push_back(std::move(comparison));
    }
  }
  return comparisons;
}

std::string pattern_markdown(const std::vector<BenchmarkCell>& cells) {
  const std::vector<PatternComparison> comparisons = compare_with_patterns(cells);
  if (comparisons.empty()) return "";
  const bool is_in_minutes = std::ranges::all_of(comparisons, &PatternComparison::is_in_minutes);
  const std::string unit = is_in_minutes ? "min" : "m";
  std::string text =
      "\n## Comparison with standard patterns\n"
      "\n"
      "Effort is the flight time from take-off to the "
      "last view, or the path length without a vehicle. Patterns are granted the outline and the "
      "heights of the target; the planners receive neither. Equal coverage: the largest that every "
      "survey of both reaches. Ratio: effort of the pattern over that of the planner at equal "
      "coverage.\n"
      "\n";
  const std::vector<std::string> head{"mission",
                                      "planner",
                                      "pattern",
                                      "planner [% of the visible surface]",
                                      "planner [" + unit + "]",
                                      "pattern [% of the visible surface]",
                                      "pattern [" + unit + "]",
                                      "pattern [% of the surface]",
                                      "planner at the pattern's effort [% of the surface]",
                                      "equal coverage [% of the surface]",
                                      "planner until then [" + unit + "]",
                                      "pattern until then [" + unit + "]",
                                      "ratio"};
  text += table_row(head) + table_rule(head.size());
  for (const PatternComparison& comparison : comparisons) {
    const bool is_timed = comparison.is_in_minutes;
    const std::optional<double> ratio = comparison.ratio();
    text += table_row(
        {comparison.mission, to_title(comparison.planner), to_title(comparison.pattern),
         percent_text(comparison.planner_visible), effort_text(comparison.planner_effort, is_timed),
         percent_text(comparison.pattern_visible), effort_text(comparison.pattern_effort, is_timed),
         percent_text(comparison.pattern_coverage),
         percent_text(comparison.coverage_at_equal_effort), percent_text(comparison.equal_coverage),
         effort_text(comparison.planner_effort_at_equal_coverage, is_timed),
         effort_text(comparison.pattern_effort_at_equal_coverage, is_timed),
         ratio ? fmt::format("{:.2f}", *ratio) : "-"});
  }
  return text;
}

}  // namespace skycap::missions::batch
