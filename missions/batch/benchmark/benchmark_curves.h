/// Mean coverage curves of a benchmark for spreadsheets and publications.
#pragma once

#include <string>
#include <vector>

#include "missions/batch/benchmark/benchmark_report.h"

namespace skycap::missions::batch {

/// Returns the text of curves.csv, with a line for each point of a curve. Columns: mission,
/// planner, axis (views, distance_m, planning_time_s, flown_s), x, mean coverage as a fraction, and
/// its standard deviation over the trials.
std::string curves_csv(const std::vector<BenchmarkCell>& cells, Times times = Times::shown);

/// Returns the text of curves.svg, which shows the same data: a row of diagrams for each mission
/// and a diagram for each axis. A band shows one standard deviation. The file contains no scripts
/// and loads no other files. Diagrams without data are not drawn.
std::string curves_svg(const std::vector<BenchmarkCell>& cells, Times times = Times::shown);

}  // namespace skycap::missions::batch
