#include "missions/benchmark/benchmark_plots.h"

#include <algorithm>

#include <fmt/format.h>

#include "missions/benchmark/contestants.h"
#include "missions/benchmark/paper_results.h"
#include "missions/plugins/external_program.h"

namespace skycap::missions::benchmark {
namespace {

constexpr std::size_t curve_points = 120;

struct Axis {
  CurveAxis axis;
  const char* name;
  const char* label;
  const char* setting;  ///< of gnuplot
};

constexpr Axis axes[] = {{CurveAxis::views, "views", "views", "unset logscale x"},
                         {CurveAxis::planning_time, "time", "planning time [s]", "set logscale x"},
                         {CurveAxis::distance, "distance", "distance [m]", "unset logscale x"}};

/// Colours that can be told apart with any kind of colour vision (Okabe and Ito), in the order of
/// the contestants.
constexpr const char* colours[] = {"#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#999999",
                                   "#56B4E9", "#8B4513", "#6A3D9A", "#000000", "#F0A0A0"};

std::size_t number_of(const std::string& planner) {
  return static_cast<std::size_t>(find_contestant(planner) - contestants().data());
}

std::string colour_of(const std::string& planner) {
  return colours[number_of(planner) % std::size(colours)];
}

/// The name of a block of data: letters, digits and underscores.
std::string block_name(const BenchmarkCell& cell, const char* what) {
  std::string name = "$" + cell.mission + "_" + std::to_string(number_of(cell.planner)) + what;
  std::ranges::replace_if(
      name, [](unsigned char c) { return c != '$' && std::isalnum(c) == 0; }, '_');
  return name;
}

std::string numbers(std::initializer_list<double> values) {
  std::string line;
  for (const double value : values) {
    line += fmt::format("{:.6g} ", value);
  }
  line.back() = '\n';
  return line;
}

std::string quoted(std::string text) {
  std::erase_if(text, [](char c) { return c == '"' || c == '\\'; });
  return '"' + text + '"';
}

/// Draws the commands in `body` into NAME.svg and NAME.png.
std::string into_both_files(const std::string& name, int width, int height,
                            const std::string& body) {
  const std::string size = std::to_string(width) + "," + std::to_string(height);
  return "set terminal svg size " + size + " font 'Helvetica,12' background '#ffffff'\n" +
         "set output " + quoted(name + ".svg") + "\n" + body + "set terminal pngcairo size " +
         size + " font 'Helvetica,10'\n" + "set output " + quoted(name + ".png") + "\n" + body +
         "unset output\n";
}

std::string curve_data(const BenchmarkCell& cell, const Axis& axis) {
  std::string text = block_name(cell, axis.name) + " << EOD\n";
  for (const CurvePoint& point : coverage_curve(cell.trials, axis.axis, curve_points)) {
    text += numbers({point.x, 100.0 * point.mean, 100.0 * (point.mean - point.deviation),
                     100.0 * std::min(1.0, point.mean + point.deviation)});
  }
  return text + "EOD\n";
}

std::string coverage_plot(const std::vector<const BenchmarkCell*>& cells, const std::string& name) {
  std::string text, body =
                        "set multiplot layout 1,3\nset yrange [0:100]\nset grid\n"
                        "set key bottom right\nset ylabel 'coverage [%]'\n";
  for (const Axis& axis : axes) {
    body += std::string(axis.setting) + "\nset xlabel '" + axis.label + "'\nplot ";
    for (const BenchmarkCell* cell : cells) {
      text += curve_data(*cell, axis);
      body += block_name(*cell, axis.name) +
              " using 1:3:4 with filledcurves fs transparent solid " + "0.15 noborder lc rgb '" +
              colour_of(cell->planner) + "' notitle, ";
    }
    for (const BenchmarkCell* cell : cells) {
      body += block_name(*cell, axis.name) + " using 1:2 with lines lw 1.5 lc rgb '" +
              colour_of(cell->planner) + "' title " +
              quoted(find_contestant(cell->planner)->title) + ", ";
    }
    body += "\nunset key\n";
  }
  return text + into_both_files(name, 1200, 420, body + "unset multiplot\n");
}

/// SEE's and SEE++'s trials on the standard models, as one cell each.
std::vector<BenchmarkCell> standard_cells(const std::vector<BenchmarkCell>& cells) {
  std::vector<BenchmarkCell> joined;
  for (const char* planner : {"see", "see++"}) {
    BenchmarkCell all{"standard models", planner, {}};
    for (const BenchmarkCell& cell : cells) {
      if (cell.planner != planner || !is_standard_model(cell.mission)) continue;
      all.trials.insert(all.trials.end(), cell.trials.begin(), cell.trials.end());
    }
    if (target_figures(all.trials).targets > 0) joined.push_back(std::move(all));
  }
  return joined;
}

std::string target_plot(const std::vector<BenchmarkCell>& cells, const std::string& name) {
  std::string text, views = "plot ", distances = "plot ";
  double offset = -0.2;
  for (const BenchmarkCell& cell : cells) {
    const TargetFigures figures = target_figures(cell.trials);
    text += block_name(cell, "views") + " << EOD\n";
    for (std::size_t i = 0; i < figures.share_by_views.size(); ++i) {
      text += numbers({static_cast<double>(i + 1) + offset, 100.0 * figures.share_by_views[i]});
    }
    text += "EOD\n" + block_name(cell, "distance") + " << EOD\n0 0\n";
    for (std::size_t i = 0; i < figures.share_by_distance.size(); ++i) {
      text += numbers(
          {target_distance_bin * static_cast<double>(i + 1), 100.0 * figures.share_by_distance[i]});
    }
    text += "EOD\n";
    offset += 0.4;
    const std::string style = " lc rgb '" + colour_of(cell.planner) + "' title " +
                              quoted(find_contestant(cell.planner)->title) + ", ";
    views += block_name(cell, "views") + " using 1:2 with boxes fs solid 0.6" + style;
    distances += block_name(cell, "distance") + " using 1:2 with linespoints lw 2" + style;
  }
  const std::string body =
      "set multiplot layout 1,2\nset grid\nset boxwidth 0.4\n"
      "unset logscale x\nset key default\nset yrange [0:100]\n"
      "set xlabel 'views until a target is observed'\n"
      "set ylabel 'share of targets [%]'\n" +
      views +
      "\nset key bottom right\n"
      "set xlabel 'observed within this distance [m]'\n" +
      distances + "\nunset multiplot\n";
  return text + into_both_files(name, 900, 380, body);
}

}  // namespace

PlotScript plot_script(const std::vector<BenchmarkCell>& cells) {
  PlotScript script;
  std::vector<std::string> missions;
  for (const BenchmarkCell& cell : cells) {
    if (!cell.trials.empty() && std::ranges::find(missions, cell.mission) == missions.end()) {
      missions.push_back(cell.mission);
    }
  }
  for (const std::string& mission : missions) {
    std::vector<const BenchmarkCell*> drawn;
    for (const BenchmarkCell& cell : cells) {
      if (cell.mission == mission && !cell.trials.empty()) drawn.push_back(&cell);
    }
    script.plots.push_back("coverage_" + mission);
    script.text += coverage_plot(drawn, script.plots.back());
  }
  if (const auto joined = standard_cells(cells); !joined.empty()) {
    script.plots.emplace_back("targets");
    script.text += target_plot(joined, script.plots.back());
  }
  return script;
}

std::string draw_plots(const std::filesystem::path& folder, const std::string& script) {
  const plugins::ProgramResult result = plugins::run_external_program({"gnuplot", script}, folder);
  if (result.exit_code == 127) return "gnuplot is not installed; install it (gnuplot-nox)";
  if (result.exit_code == 0) return "";
  return "gnuplot failed: " + result.output;
}

}  // namespace skycap::missions::benchmark
