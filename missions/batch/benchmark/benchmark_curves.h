/// Mean coverage curves of a benchmark for spreadsheets and publications.
#pragma once

#include <string>
#include <vector>

#include "missions/batch/benchmark/benchmark_report.h"

namespace skycap::missions::batch {

/// curves.csv: mission, planner, axis (views, distance_m, planning_time_s, flown_s), x, mean
/// coverage (a share) and its standard deviation over the trials; a line for each point.
std::string curves_csv(const std::vector<BenchmarkCell>& cells, Times times = Times::shown);

/// curves.svg: the same as a drawing, a row of diagrams for each mission and a diagram for each
/// axis, with one standard deviation as a band. It has no scripts and loads nothing. Diagrams
/// without data are left out.
std::string curves_svg(const std::vector<BenchmarkCell>& cells, Times times = Times::shown);

}  // namespace skycap::missions::batch
