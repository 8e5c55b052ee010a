/// Writes results of trials and benchmarks as CSV, JSON and Markdown.
#pragma once

#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/batch/benchmark/benchmark_results.h"

namespace skycap::missions::batch {

/// Whether a table includes planning times. They depend on the machine and its load; all other
/// figures are reproducible.
enum class Times { shown, left_out };

/// Returns trials.csv, with one line per trial.
std::string trials_csv(const std::vector<Trial>& trials, Times times = Times::shown);

/// Returns trials.json: statistics, mean curves, each trial, and the mission's reference results. A
/// finished trial keeps its final coverage in the curves.
std::string trials_json(const config::MissionSetup& mission, const std::vector<Trial>& trials,
                        std::size_t requested, unsigned threads);

/// Returns the table for the terminal: means, half widths of the confidence intervals, and the
/// mission's reference results.
std::string trials_table(const config::MissionSetup& mission, const std::vector<Trial>& trials);

/// Returns results.json. For each mission and planner it contains all figures with deviations and
/// 95% confidence intervals, curves, trials and frontier statistics. The paper's values and ratios
/// to them are included.
std::string results_json(const std::vector<BenchmarkCell>& cells);

/// Returns table1.csv, with one line per mission and planner.
std::string table_1_csv(const std::vector<BenchmarkCell>& cells, Times times = Times::shown);

/// Returns trials.csv, with one line per trial.
std::string all_trials_csv(const std::vector<BenchmarkCell>& cells, Times times = Times::shown);

/// Returns report.md: Tables 1 and 2 in the layout of the paper, and Figure 6. Each figure is
/// listed with its confidence interval, the paper's value and the ratio of both. `title` is the
/// heading.
std::string report_markdown(const std::vector<BenchmarkCell>& cells,
                            const std::string& title = "Benchmark", Times times = Times::shown);

/// Stages report.md, results.json, table1.csv and trials.csv. Returns report.md. `times` does not
/// apply to results.json, which always contains planning times.
std::string stage_tables(const std::vector<BenchmarkCell>& cells, const std::string& title,
                         Times times, geometry::OutputFolder& folder);

/// A completed item, one line of times.csv.
struct ItemTimes {
  std::size_t number = 0;
  double planning_time = 0.0;  ///< processor time [s]
  TrialRun run;
};

/// Returns times.csv, with the duration and the host of each item.
std::string times_csv(const std::vector<ItemTimes>& items);

}  // namespace skycap::missions::batch
