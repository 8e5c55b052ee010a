#include "missions/batch/benchmark/uniform_comparison.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "missions/batch/benchmark/markdown_table.h"
#include "missions/batch/benchmark/methods.h"

namespace skycap::missions::batch {
namespace {

/// Returns the sets of `uniform` on a mission by their number of views.
std::map<std::size_t, const BenchmarkCell*> find_sets(const std::vector<BenchmarkCell>& cells,
                                                      const std::string& mission) {
  std::map<std::size_t, const BenchmarkCell*> sets;
  for (const BenchmarkCell& cell : cells) {
    if (cell.mission != mission || cell.planner != "uniform" || !cell.set_views) continue;
    if (!cell.trials.empty()) sets.emplace(*cell.set_views, &cell);
  }
  return sets;
}

/// `sign` is 1 if more is better, and -1 if less is better.
template <typename Figure>
std::optional<PairedDifference> compute_difference(const BenchmarkCell& cell,
                                                   const BenchmarkCell& other, Figure figure,
                                                   double sign) {
  std::vector<double> differences;
  for (const Trial& trial : cell.trials) {
    const auto twin = std::ranges::find(other.trials, trial.seed, &Trial::seed);
    if (twin != other.trials.end()) differences.push_back(figure(trial) - figure(*twin));
  }
  if (differences.empty()) return std::nullopt;
  PairedDifference result{statistic(differences), Outcome::no_difference};
  if (std::abs(result.difference.mean) > result.difference.half_width_95) {
    result.outcome = sign * result.difference.mean > 0.0 ? Outcome::better : Outcome::worse;
  }
  return result;
}

double coverage(const Trial& trial) { return trial.coverage.all; }
double distance(const Trial& trial) { return trial.distance; }

std::string to_string(const Statistic& figure, double unit) {
  std::string text = fmt::format("{:.1f}", figure.mean / unit);
  if (std::isfinite(figure.half_width_95)) {
    text += fmt::format(" ± {:.2g}", figure.half_width_95 / unit);
  }
  return text;
}

std::string difference_text(const std::optional<PairedDifference>& difference, double unit) {
  if (!difference) return "-";
  std::string text = fmt::format("{:+.1f}", difference->difference.mean / unit);
  if (std::isfinite(difference->difference.half_width_95)) {
    text += fmt::format(" ± {:.2g}", difference->difference.half_width_95 / unit);
  }
  return text;
}

constexpr double percent = 0.01;

std::string comparison_table(const std::vector<UniformComparison>& comparisons) {
  const std::vector<std::string> head{"planner",
                                      "mission",
                                      "views",
                                      "coverage [%]",
                                      "path [m]",
                                      "at the same number of views: coverage - uniform [%]",
                                      "path - uniform [m]",
                                      "verdict",
                                      "views with which uniform reaches its coverage",
                                      "path of that tour [m]"};
  std::string text = table_row(head) + table_rule(head.size());
  for (const UniformComparison& comparison : comparisons) {
    text += table_row(
        {to_title(comparison.planner), comparison.mission, to_string(comparison.views, 1.0),
         to_string(comparison.coverage, percent), to_string(comparison.distance, 1.0),
         difference_text(comparison.coverage_difference, percent),
         difference_text(comparison.distance_difference, 1.0), comparison.verdict(),
         comparison.reaching_views ? std::to_string(*comparison.reaching_views)
                                   : fmt::format("more than {}", comparison.max_tested_views),
         comparison.reaching_distance ? to_string(*comparison.reaching_distance, 1.0) : "-"});
  }
  return text;
}

std::string sets_table(const std::vector<BenchmarkCell>& cells) {
  const std::vector<std::string> head{"fixed views", "mission",      "views",
                                      "trials",      "coverage [%]", "path [m]"};
  std::string text = table_row(head) + table_rule(head.size());
  for (const BenchmarkCell& cell : cells) {
    if (!cell.set_views || cell.trials.empty()) continue;
    const CellFigures figures = compute_figures(cell);
    text += table_row({to_title(cell.planner), cell.mission, std::to_string(*cell.set_views),
                       std::to_string(cell.trials.size()), to_string(figures.coverage, percent),
                       to_string(figures.distance, 1.0)});
  }
  return text;
}

}  // namespace

bool UniformComparison::beats_uniform() const {
  if (!coverage_difference || !distance_difference) return false;
  const Outcome more = coverage_difference->outcome, shorter = distance_difference->outcome;
  return (more == Outcome::better || shorter == Outcome::better) && more != Outcome::worse &&
         shorter != Outcome::worse;
}

std::string UniformComparison::verdict() const {
  if (!coverage_difference || !distance_difference) return "-";
  if (beats_uniform()) return "beats uniform";
  const Outcome more = coverage_difference->outcome, shorter = distance_difference->outcome;
  if (more == Outcome::better) return "more coverage, longer path";
  if (shorter == Outcome::better) return "shorter path, less coverage";
  return "does not beat uniform";
}

std::size_t compute_same_views(const BenchmarkCell& cell) {
  double sum = 0.0;
  for (const Trial& trial : cell.trials) sum += static_cast<double>(trial.views);
  const double mean = cell.trials.empty() ? 1.0 : sum / static_cast<double>(cell.trials.size());
  return static_cast<std::size_t>(std::max(1L, std::lround(mean)));
}

std::vector<UniformComparison> compare_with_uniform(const std::vector<BenchmarkCell>& cells) {
  std::vector<UniformComparison> comparisons;
  for (const BenchmarkCell& cell : cells) {
    const auto sets = find_sets(cells, cell.mission);
    if (cell.set_views || cell.trials.empty() || sets.empty()) continue;
    const CellFigures figures = compute_figures(cell);
    UniformComparison comparison{.mission = cell.mission,
                                 .planner = cell.planner,
                                 .views = figures.views,
                                 .coverage = figures.coverage,
                                 .distance = figures.distance,
                                 .same_views = compute_same_views(cell),
                                 .max_tested_views = sets.rbegin()->first};
    if (const auto same = sets.find(comparison.same_views); same != sets.end()) {
      const CellFigures uniform = compute_figures(*same->second);
      comparison.uniform_coverage = uniform.coverage;
      comparison.uniform_distance = uniform.distance;
      comparison.coverage_difference = compute_difference(cell, *same->second, coverage, 1.0);
      comparison.distance_difference = compute_difference(cell, *same->second, distance, -1.0);
    }
    for (const auto& [views, set] : sets) {
      const CellFigures uniform = compute_figures(*set);
      if (uniform.coverage.mean < figures.coverage.mean) continue;
      comparison.reaching_views = views;
      comparison.reaching_distance = uniform.distance;
      break;
    }
    comparisons.push_back(std::move(comparison));
  }
  return comparisons;
}

std::optional<std::size_t> next_set_views(const BenchmarkCell& cell,
                                          const std::vector<BenchmarkCell>& cells) {
  if (cell.set_views || cell.trials.empty()) return std::nullopt;
  const double target = compute_figures(cell).coverage.mean;
  std::size_t below = 0;
  for (const auto& [views, set] : find_sets(cells, cell.mission)) {
    if (compute_figures(*set).coverage.mean < target) {
      below = views;
    } else if (views - below > 1) {
      return below + (views - below) / 2;
    } else {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

std::string uniform_markdown(const std::vector<BenchmarkCell>& cells) {
  if (std::ranges::none_of(cells,
                           [](const BenchmarkCell& cell) { return cell.set_views.has_value(); })) {
    return "";
  }
  std::string text =
      "\n## Comparison with surveys without planning\n"
      "\n"
      "Uniform: a fixed set of views, evenly distributed over a sphere, with a short tour. Each "
      "number of views has a set and a tour of its own. Fixed views are granted the centroid and "
      "the mean radius of the true surface and the positions that the true scene admits; the "
      "planners receive none of these. Differences are paired by seed. A planner is called better "
      "or worse only if the 95% confidence interval of the difference excludes zero.\n"
      "\n";
  const auto comparisons = compare_with_uniform(cells);
  if (!comparisons.empty()) text += comparison_table(comparisons) + "\n";
  return text + "Fixed views by number of views:\n\n" + sets_table(cells);
}

}  // namespace skycap::missions::batch
