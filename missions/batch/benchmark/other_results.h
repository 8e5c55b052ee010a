/// Results of surveys planned by other programs, for comparison with Skycap's results.
#pragma once

#include <filesystem>
#include <vector>

#include "missions/batch/benchmark/benchmark_results.h"

namespace skycap::missions::batch {

/// Reads a JSON file that contains one object {"planner", "mission", "trials"} or a list of them.
/// Each trial has two lists of equal length, with a number for each view. "coverage_after" is the
/// covered fraction of the surface in [0, 1]. "distance_after_m" is the distance travelled [m].
/// Optional fields are "seed", "stop_reason" (default: complete), "planning_time_after_s",
/// "coverage_visible" and "points". Other figures are computed from the lists. Unknown fields are
/// ignored.
///
/// Throws Error{bad_file} with the file, trial and field if a value is missing, has the wrong type,
/// is not finite or is out of range. It also throws if a list decreases.
std::vector<BenchmarkCell> read_other_results(const std::filesystem::path& file);

}  // namespace skycap::missions::batch
