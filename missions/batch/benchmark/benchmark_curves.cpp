#include "missions/batch/benchmark/benchmark_curves.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "missions/batch/benchmark/methods.h"
#include "missions/support/number_text.h"

namespace skycap::missions::batch {
namespace {

constexpr std::size_t points_a_curve = 100;

struct Axis {
  CurveAxis axis;
  const char* key;
  const char* title;
  bool is_logarithmic;
};

constexpr std::array all_axes{
    Axis{CurveAxis::views, "views", "views", false},
    Axis{CurveAxis::distance, "distance_m", "distance [m]", false},
    Axis{CurveAxis::planning_time, "planning_time_s", "planning time [s]", true},
    Axis{CurveAxis::flight_time, "flown_s", "flight time [s]", false}};

std::vector<Axis> axes(Times times) {
  std::vector<Axis> chosen;
  for (const Axis& axis : all_axes) {
    if (times == Times::shown || axis.axis != CurveAxis::planning_time) chosen.push_back(axis);
  }
  return chosen;
}

/// Planning times of other programs may be unknown. Zeros cannot be drawn on a logarithmic axis.
std::vector<CurvePoint> curve_of(const BenchmarkCell& cell, const Axis& axis) {
  if (cell.trials.empty()) return {};
  const auto is_timed = [](const Trial& trial) { return trial.planning_time > 0.0; };
  if (axis.is_logarithmic && !std::ranges::all_of(cell.trials, is_timed)) return {};
  return coverage_curve(cell.trials, axis.axis, points_a_curve);
}

std::string xml_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

/// Colours of Okabe and Ito, which people with colour vision deficiency can distinguish.
constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00",
                             "#56b4e9", "#7f7f7f", "#000000", "#8c510a", "#5e3c99"};

struct Line {
  std::string title;
  const char* colour;
  std::vector<CurvePoint> points;
};

/// Returns a round step that divides a length into at most six parts.
double compute_step(double length) {
  const double unit = std::pow(10.0, std::floor(std::log10(length / 6.0)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (length / (factor * unit) <= 6.0) return factor * unit;
  }
  return 10.0 * unit;
}

/// Diagram of coverage in percent, 300 x 200, with its origin at the lower left corner of the
/// frame.
class Diagram {
 public:
  static constexpr double width = 300.0, height = 200.0;

  Diagram(const Axis& axis, const std::vector<Line>& lines) : axis_(axis) {
    for (const Line& line : lines) {
      if (line.points.empty()) continue;
      min_ = std::min(min_, line.points.front().x);
      max_ = std::max(max_, line.points.back().x);
    }
    if (!axis.is_logarithmic) min_ = 0.0;
    if (!(max_ > min_)) max_ = min_ + 1.0;
  }

  std::string text(const std::vector<Line>& lines) const {
    std::string svg = grid();
    for (const Line& line : lines) svg += band(line) + curve(line);
    return svg + fmt::format("<text x=\"{:g}\" y=\"34\" text-anchor=\"middle\">{}</text>\n",
                             0.5 * width, axis_.title);
  }

 private:
  double across(double x) const {
    const double share = axis_.is_logarithmic ? std::log(x / min_) / std::log(max_ / min_)
                                              : (x - min_) / (max_ - min_);
    return width * share;
  }
  static double up(double coverage) { return -height * std::clamp(coverage, 0.0, 1.0); }

  std::string grid() const {
    std::string svg;
    for (int percent = 0; percent <= 100; percent += 20) {
      const double y = up(0.01 * percent);
      svg += fmt::format(
          "<path class=\"grid\" d=\"M0 {0:.2f}H{1:g}\"/><text x=\"-6\" y=\"{2:.2f}\" "
          "text-anchor=\"end\">{3}</text>\n",
          y, width, y + 4.0, percent);
    }
    for (const double x : ticks()) {
      svg += fmt::format(
          "<path class=\"grid\" d=\"M{0:.2f} 0V{1:g}\"/><text x=\"{0:.2f}\" y=\"16\" "
          "text-anchor=\"middle\">{2}</text>\n",
          across(x), -height, support::short_text(x));
    }
    return svg;
  }

  std::vector<double> ticks() const {
    std::vector<double> positions;
    if (axis_.is_logarithmic) {
      const double first = std::pow(10.0, std::ceil(std::log10(min_) - 1e-9));
      for (double x = first; x <= max_ * (1.0 + 1e-9); x *= 10.0) positions.push_back(x);
      if (positions.empty()) positions = {min_, max_};
      return positions;
    }
    const double step = compute_step(max_ - min_);
    for (int i = 0; i * step <= max_ * (1.0 + 1e-9); ++i) positions.push_back(i * step);
    return positions;
  }

  std::string curve(const Line& line) const {
    if (line.points.empty()) return "";
    std::string path;
    for (const CurvePoint& point : line.points) {
      path +=
          fmt::format("{}{:.2f} {:.2f}", path.empty() ? "M" : "L", across(point.x), up(point.mean));
    }
    return fmt::format("<path class=\"curve\" stroke=\"{}\" d=\"{}\"/>\n", line.colour, path);
  }

  std::string band(const Line& line) const {
    if (line.points.empty()) return "";
    std::string upper, lower;
    for (const CurvePoint& point : line.points) {
      upper += fmt::format("{}{:.2f} {:.2f}", upper.empty() ? "M" : "L", across(point.x),
                           up(point.mean + point.deviation));
      lower =
          fmt::format("L{:.2f} {:.2f}", across(point.x), up(point.mean - point.deviation)) + lower;
    }
    return fmt::format("<path fill=\"{}\" fill-opacity=\"0.15\" d=\"{}{}Z\"/>\n", line.colour,
                       upper, lower);
  }

  const Axis& axis_;
  double min_ = 1e300, max_ = 0.0;
};

std::vector<std::string> missions_of(const std::vector<BenchmarkCell>& cells) {
  std::vector<std::string> missions;
  for (const BenchmarkCell& cell : cells) {
    if (std::ranges::find(missions, cell.mission) == missions.end())
      missions.push_back(cell.mission);
  }
  return missions;
}

/// Returns the curves of a mission along an axis. Each planner has the same colour in all diagrams.
std::vector<Line> split_lines(const std::vector<BenchmarkCell>& cells, const std::string& mission,
                              const Axis& axis) {
  std::vector<std::string> planners;
  std::vector<Line> lines;
  for (const BenchmarkCell& cell : cells) {
    auto known = std::ranges::find(planners, cell.planner);
    if (known == planners.end()) known = planners.insert(planners.end(), cell.planner);
    if (cell.mission != mission) continue;
    const auto number = static_cast<std::size_t>(known - planners.begin());
    lines.push_back(
        {to_title(cell.planner), colours[number % colours.size()], curve_of(cell, axis)});
  }
  return lines;
}

std::string legend(const std::vector<Line>& lines) {
  std::string svg;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double y = -Diagram::height + 14.0 + 18.0 * static_cast<double>(i);
    svg += fmt::format(
        "<path class=\"curve\" stroke=\"{0}\" d=\"M0 {1:g}H22\"/><text x=\"28\" y=\"{2:g}\">{3}"
        "</text>\n",
        lines[i].colour, y, y + 4.0, xml_text(lines[i].title));
  }
  return svg;
}

}  // namespace

std::string curves_csv(const std::vector<BenchmarkCell>& cells, Times times) {
  std::string csv = "mission,planner,axis,x,coverage,standard_deviation\n";
  for (const BenchmarkCell& cell : cells) {
    for (const Axis& axis : axes(times)) {
      for (const CurvePoint& point : curve_of(cell, axis)) {
        csv += cell.mission + "," + cell.planner + "," + axis.key + "," +
               support::exact_text(point.x) + "," + support::exact_text(point.mean) + "," +
               support::exact_text(point.deviation) + "\n";
      }
    }
  }
  return csv;
}

std::string curves_svg(const std::vector<BenchmarkCell>& cells, Times times) {
  constexpr double left = 60.0, top = 40.0, across = Diagram::width + 60.0;
  constexpr double down = Diagram::height + 90.0, legend_width = 160.0;
  std::string diagrams;
  double y = top, widest = 0.0;
  for (const std::string& mission : missions_of(cells)) {
    double x = left;
    std::vector<Line> named;
    for (const Axis& axis : axes(times)) {
      const std::vector<Line> lines = split_lines(cells, mission, axis);
      const auto has_points = [](const Line& line) { return !line.points.empty(); };
      if (std::ranges::none_of(lines, has_points)) continue;
      diagrams += fmt::format("<g transform=\"translate({:g} {:g})\">\n{}</g>\n", x,
                              y + Diagram::height, Diagram(axis, lines).text(lines));
      named = lines;
      x += across;
    }
    if (named.empty()) continue;
    diagrams += fmt::format(
        "<text x=\"{:g}\" y=\"{:g}\" font-weight=\"bold\">{}: coverage of the surface [%]</text>\n"
        "<g transform=\"translate({:g} {:g})\">\n{}</g>\n",
        left, y - 14.0, xml_text(mission), x - 30.0, y + Diagram::height, legend(named));
    widest = std::max(widest, x + legend_width);
    y += down;
  }
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 "
      "{0:g} {1:g}\" font-family=\"sans-serif\" font-size=\"12\">\n<style>.grid{{stroke:#ddd;"
      "fill:none}}.curve{{fill:none;stroke-width:2}}</style>\n<rect width=\"100%\" "
      "height=\"100%\" fill=\"#fff\"/>\n{2}</svg>\n",
      std::max(widest, left), y, diagrams);
}

}  // namespace skycap::missions::batch
