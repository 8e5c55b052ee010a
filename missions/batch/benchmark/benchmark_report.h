/// A benchmark's results as files for programs, spreadsheets and readers.
#pragma once

#include <string>
#include <vector>

#include "missions/batch/benchmark/benchmark_results.h"

namespace skycap::missions::batch {

/// results.json: for each mission and planner all figures with deviations and 95 % intervals, the
/// paper's values and our ratio to them, curves, each trial, and frontier statistics.
std::string results_json(const std::vector<BenchmarkCell>& cells);

/// table1.csv: a line for each mission and planner.
std::string table_1_csv(const std::vector<BenchmarkCell>& cells, Times times = Times::shown);

/// trials.csv: a line for each trial.
std::string all_trials_csv(const std::vector<BenchmarkCell>& cells, Times times = Times::shown);

/// report.md: Tables 1 and 2 in the paper's form with its values beside ours, each figure with its
/// certainty and its ratio to the paper's, and Figure 6. `title` is its heading.
std::string report_markdown(const std::vector<BenchmarkCell>& cells,
                            const std::string& title = "Benchmark", Times times = Times::shown);

}  // namespace skycap::missions::batch
