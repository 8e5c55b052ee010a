/// A benchmark's plots, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "missions/benchmark/benchmark_results.h"

namespace skycap::missions::benchmark {

/// A script for gnuplot, data included, and the plots that it draws: for each name an SVG and a
/// PNG file.
struct PlotScript {
  std::string text;
  std::vector<std::string> plots;
};

/// For each mission coverage against views, planning time and distance, with bands of one
/// standard deviation; for SEE and SEE++ the statistics of their targets.
PlotScript plot_script(const std::vector<BenchmarkCell>& cells);

/// Runs a script that is in `folder`. What gnuplot complained of, or empty; that it is not
/// installed is a complaint, too.
std::string draw_plots(const std::filesystem::path& folder, const std::string& script);

}  // namespace skycap::missions::benchmark
