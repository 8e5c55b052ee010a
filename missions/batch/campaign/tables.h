/// What a campaign's items come to: tables, curves and their page.
#pragma once

#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/batch/benchmark/benchmark_results.h"
#include "missions/batch/benchmark/trial_files.h"

namespace skycap::missions::batch {

/// Stages report.md, results.json, table1.csv and trials.csv; returns the first. Of planning times
/// only results.json tells in any case.
std::string stage_tables(const std::vector<batch::BenchmarkCell>& cells, const std::string& title,
                         batch::Times times, geometry::OutputFolder& folder);

/// An item that is finished, as a line of times.csv.
struct ItemTimes {
  std::size_t number = 0;
  double planning_time = 0.0;  ///< [s] of a processor
  batch::TrialRun run;
};

/// times.csv: what each item took, and where it ran.
std::string times_csv(const std::vector<ItemTimes>& items);

}  // namespace skycap::missions::batch
