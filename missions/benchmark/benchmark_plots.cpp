#include "missions/benchmark/benchmark_plots.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
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

/// The name of a block of data; `plot` is the name of the plot's files.
std::string block_name(const std::string& plot, const BenchmarkCell& cell, const char* what) {
  return "$" + plot + "_" + std::to_string(number_of(cell.planner)) + what;
}

std::string numbers(std::initializer_list<double> values) {
  std::string line;
  for (const double value : values) {
    line += fmt::format("{:.6g} ", value);
  }
  line.back() = '\n';
  return line;
}

/// Draws the commands in `body` into NAME.svg and NAME.png.
std::string into_both_files(const std::string& name, int width, int height,
                            const std::string& body) {
  const std::string size = std::to_string(width) + "," + std::to_string(height);
  return "set terminal svg size " + size + " font 'Helvetica,12' background '#ffffff'\n" +
         "set output '" + name + ".svg'\n" + body + "set terminal pngcairo size " + size +
         " font 'Helvetica,10'\n" + "set output '" + name + ".png'\n" + body + "unset output\n";
}

/// One of our own titles, without quotes in it.
std::string title_of(const std::string& planner) {
  return "'" + find_contestant(planner)->title + "'";
}

std::string curve_data(const std::string& plot, const BenchmarkCell& cell, const Axis& axis) {
  std::string text = block_name(plot, cell, axis.name) + " << EOD\n";
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
      text += curve_data(name, *cell, axis);
      body += block_name(name, *cell, axis.name) +
              " using 1:3:4 with filledcurves fs transparent solid " + "0.15 noborder lc rgb '" +
              colour_of(cell->planner) + "' notitle, ";
    }
    for (const BenchmarkCell* cell : cells) {
      body += block_name(name, *cell, axis.name) + " using 1:2 with lines lw 1.5 lc rgb '" +
              colour_of(cell->planner) + "' title " + title_of(cell->planner) + ", ";
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
    text += block_name(name, cell, "views") + " << EOD\n";
    for (std::size_t i = 0; i < figures.share_by_views.size(); ++i) {
      text += numbers({static_cast<double>(i + 1) + offset, 100.0 * figures.share_by_views[i]});
    }
    text += "EOD\n" + block_name(name, cell, "distance") + " << EOD\n0 0\n";
    for (std::size_t i = 0; i < figures.share_by_distance.size(); ++i) {
      text += numbers(
          {target_distance_bin * static_cast<double>(i + 1), 100.0 * figures.share_by_distance[i]});
    }
    text += "EOD\n";
    offset += 0.4;
    const std::string style =
        " lc rgb '" + colour_of(cell.planner) + "' title " + title_of(cell.planner) + ", ";
    views += block_name(name, cell, "views") + " using 1:2 with boxes fs solid 0.6" + style;
    distances += block_name(name, cell, "distance") + " using 1:2 with linespoints lw 2" + style;
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

/// A folder for gnuplot to work in: what it leaves there may be torn.
class ScratchFolder {
 public:
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {
    std::error_code failure;
    std::filesystem::remove_all(path_, failure);  // of a killed run
    std::filesystem::create_directory(path_, failure);
    if (failure) {
      throw Error(ErrorKind::bad_file, path_.string() + ": cannot be made: " + failure.message());
    }
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Whether a picture has its end: gnuplot does not always notice a full disk.
bool is_whole(const std::filesystem::path& file) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(file, failure)) return false;
  std::string bytes = geometry::read_file(file);
  while (bytes.ends_with('\n')) bytes.pop_back();
  return file.extension() == ".png" ? bytes.ends_with("IEND\xAE\x42\x60\x82")
                                    : bytes.ends_with("</svg>");
}

std::string plot_name(std::size_t number) { return "plot_" + std::to_string(number); }

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
    script.text += coverage_plot(drawn, plot_name(script.plots.size()));
  }
  if (const auto joined = standard_cells(cells); !joined.empty()) {
    script.plots.emplace_back("targets");
    script.text += target_plot(joined, plot_name(script.plots.size()));
  }
  return script;
}

DrawnPlots draw_plots(const PlotScript& script, geometry::OutputFolder& folder) {
  if (script.plots.empty()) return {};
  const ScratchFolder scratch(folder.path() / ".part-plots");
  geometry::write_file(scratch.path() / "plots.gp", script.text);
  // -d: not what the user's own settings say.
  const plugins::ProgramResult result =
      plugins::run_external_program({"gnuplot", "-d", "plots.gp"}, scratch.path());
  if (result.exit_code == 127) {
    return {false, "gnuplot is not installed; install it (gnuplot-nox)"};
  }
  if (result.exit_code != 0) return {true, "gnuplot failed: " + result.output};
  for (const char* ending : {".svg", ".png"}) {
    for (std::size_t i = 1; i <= script.plots.size(); ++i) {
      if (!is_whole(scratch.path() / (plot_name(i) + ending))) {
        return {true, "gnuplot left a plot unfinished; is the disk full? " + result.output};
      }
    }
  }
  for (const char* ending : {".svg", ".png"}) {
    for (std::size_t i = 1; i <= script.plots.size(); ++i) {
      folder.write(script.plots[i - 1] + ending,
                   geometry::read_file(scratch.path() / (plot_name(i) + ending)));
    }
  }
  return {};
}

}  // namespace skycap::missions::benchmark
