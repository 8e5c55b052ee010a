/// A benchmark's plots, drawn by gnuplot.
#pragma once

#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/benchmark/benchmark_results.h"

namespace skycap::missions::benchmark {

/// A script for gnuplot, data included. It holds numbers and words of ours only, nothing that a
/// user has named: gnuplot runs what it finds between backquotes. Plot i is drawn into plot_i.svg
/// and plot_i.png, i counted from one.
struct PlotScript {
  std::string text;
  std::vector<std::string> plots;  ///< the names that the files are to have, without ending
};

/// For each mission coverage against views, planning time and distance, with bands of one
/// standard deviation; for SEE and SEE++ the statistics of their targets.
PlotScript plot_script(const std::vector<BenchmarkCell>& cells);

struct DrawnPlots {
  bool has_gnuplot = true;
  std::string complaint;  ///< why there are no plots; empty: all are there
};

/// Draws the plots and stages them in `folder`, an SVG and a PNG file each, or none. Throws
/// Error{bad_file} if a file cannot be written.
DrawnPlots draw_plots(const PlotScript& script, geometry::OutputFolder& folder);

}  // namespace skycap::missions::benchmark
