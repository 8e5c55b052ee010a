/// Results of surveys that another program has planned, for comparisons with those of this one.
#pragma once

#include <filesystem>
#include <vector>

#include "missions/batch/benchmark/benchmark_results.h"

namespace skycap::missions::batch {

/// Reads a JSON file: one object {"planner", "mission", "trials"}, or a list of them. Each trial
/// has "coverage_after" (share of the surface after each view, in [0, 1]) and "distance_after_m"
/// (metres travelled until each view), lists of the same length, and may have "seed", "stop_reason"
/// (complete by default), "planning_time_after_s", "coverage_visible" and "points". Other figures
/// follow from the lists. Unknown fields are ignored.
///
/// Throws Error{bad_file} naming file, trial and field if something is missing, of another type,
/// not finite, out of range or not increasing.
std::vector<BenchmarkCell> read_other_results(const std::filesystem::path& file);

}  // namespace skycap::missions::batch
