/// Results of trials and benchmarks as files for programs, spreadsheets and readers.
#pragma once

#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/batch/benchmark/benchmark_results.h"

namespace skycap::missions::batch {

/// Whether a table holds planning times. They are of the machine and of what else it did; all else
/// is the same wherever a trial ran.
enum class Times { shown, left_out };

/// trials.csv: a line for each trial.
std::string trials_csv(const std::vector<Trial>& trials, Times times = Times::shown);

/// trials.json: statistics, mean curves (a finished trial keeps its last coverage), each trial,
/// and the mission's reference figures beside them.
std::string trials_json(const config::MissionSetup& mission, const std::vector<Trial>& trials,
                        std::size_t requested, unsigned threads);

/// The table for the terminal: means and half widths, and the mission's reference figures.
std::string trials_table(const config::MissionSetup& mission, const std::vector<Trial>& trials);

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

/// Stages report.md, results.json, table1.csv and trials.csv; returns the first. Of planning times
/// only results.json tells in any case.
std::string stage_tables(const std::vector<BenchmarkCell>& cells, const std::string& title,
                         Times times, geometry::OutputFolder& folder);

/// An item that is finished, as a line of times.csv.
struct ItemTimes {
  std::size_t number = 0;
  double planning_time = 0.0;  ///< [s] of a processor
  TrialRun run;
};

/// times.csv: what each item took, and where it ran.
std::string times_csv(const std::vector<ItemTimes>& items);

}  // namespace skycap::missions::batch
