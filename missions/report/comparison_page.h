/// HTML reports of several surveys: planner comparisons and the trials of a mission.
#pragma once

#include <cstddef>
#include <string>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// Returns the report of results.json, written by `skycap benchmark`. Throws Error{bad_file} with
/// the file name if the contents are invalid.
std::string benchmark_page(const ResultFinder& results);

/// Returns the report of trials.json, written by `skycap plan --trials`. Throws as
/// benchmark_page().
std::string trials_page(const ResultFinder& results);

}  // namespace skycap::missions::report
