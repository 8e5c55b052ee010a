#include "missions/batch/benchmark/benchmark_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/parallel.h"
#include "missions/batch/benchmark/benchmark_curves.h"
#include "missions/batch/benchmark/markdown_table.h"
#include "missions/batch/benchmark/methods.h"
#include "missions/batch/benchmark/paper_results.h"
#include "missions/batch/benchmark/pattern_comparison.h"
#include "missions/batch/benchmark/protocol_g.h"
#include "missions/batch/benchmark/uniform_comparison.h"
#include "missions/support/json_text.h"
#include "missions/support/number_text.h"
#include "missions/version.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::batch {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t curve_points = 100;

Json curve_json(const std::vector<Trial>& trials, CurveAxis axis) {
  Json x = Json::array(), mean = Json::array(), deviation = Json::array();
  for (const CurvePoint& point : coverage_curve(trials, axis, curve_points)) {
    x.push_back(point.x);
    mean.push_back(point.mean);
    deviation.push_back(point.deviation);
  }
  return {{"x", x}, {"coverage", mean}, {"standard_deviation", deviation}};
}

/// Returns {"mean", "standard_deviation", "half_width_95"}. The half width is null for a single
/// value.
Json statistic_json(const Statistic& statistic) {
  // JSON cannot represent the infinite half width of a single trial.
  return {{"mean", statistic.mean},
          {"standard_deviation", statistic.deviation},
          {"half_width_95",
           std::isfinite(statistic.half_width_95) ? Json(statistic.half_width_95) : Json()}};
}

/// Returns {"views", "planning_time_s", "distance_m", "flown_s"}: mean coverage along each
/// quantity, as a list of {"x", "coverage", "standard_deviation"}. Lists are empty for quantities
/// without data.
Json curves_json(const std::vector<Trial>& trials) {
  return {{"views", curve_json(trials, CurveAxis::views)},
          {"planning_time_s", curve_json(trials, CurveAxis::planning_time)},
          {"distance_m", curve_json(trials, CurveAxis::distance)},
          {"flown_s", curve_json(trials, CurveAxis::flight_time)}};
}

/// Returns a list of trials: {"seed", "stop_reason", "views", "coverage", "distance_m",
/// "planning_time_s"}.
Json each_trial_json(const std::vector<Trial>& trials) {
  Json list = Json::array();
  for (const Trial& trial : trials) {
    list.push_back({{"seed", trial.seed},
                    {"stop_reason", session::to_string(trial.stop_reason)},
                    {"views", trial.views},
                    {"coverage", trial.coverage.all},
                    {"distance_m", trial.distance},
                    {"flown_s", trial.has_vehicle() ? Json(*trial.flight_time()) : Json()},
                    {"planning_time_s", trial.planning_time}});
  }
  return list;
}

/// Figure by which trials are compared.
struct Figure {
  const char* name;
  double (*of)(const Trial&);
  /// Reference result in the mission, or null.
  std::optional<double> config::ReferenceResults::*reference;
  double PaperResult::*in_table_1;  ///< column of Table 1, or null
};

constexpr std::array trial_figures{
    Figure{"views", [](const Trial& t) { return static_cast<double>(t.views); },
           &config::ReferenceResults::views, &PaperResult::views},
    Figure{"coverage", [](const Trial& t) { return t.coverage.all; },
           &config::ReferenceResults::coverage, &PaperResult::coverage},
    // No reference, because publications do not state the invisible fraction of the surface.
    Figure{"coverage_visible", [](const Trial& t) { return t.coverage.visible.value_or(0.0); },
           nullptr, nullptr},
    Figure{"distance_m", [](const Trial& t) { return t.distance; },
           &config::ReferenceResults::distance, &PaperResult::distance},
    Figure{"planning_time_s", [](const Trial& t) { return t.planning_time; },
           &config::ReferenceResults::planning_time, &PaperResult::planning_time}};

/// Returns the reference result given in the mission, or else the SEE++ paper's result for the
/// model.
std::optional<double> find_reference(const config::MissionSetup& mission, const Figure& figure) {
  if (figure.reference == nullptr) return std::nullopt;
  if (const auto& given = mission.reference.*figure.reference) return given;
  const auto paper =
      paper_result(mission.name, survey::find_title(mission.survey().planner.name).word);
  return paper ? std::optional((*paper).*figure.in_table_1) : std::nullopt;
}

Statistic compute_statistic(const std::vector<Trial>& trials, const Figure& figure) {
  std::vector<double> numbers;
  numbers.reserve(trials.size());
  for (const Trial& trial : trials) numbers.push_back(figure.of(trial));
  return statistic(numbers);
}

/// Returns the mean curve over the trials, indexed by view. A trial that has ended keeps its final
/// value.
std::vector<double> mean_curve(const std::vector<Trial>& trials,
                               std::vector<double> Trial::*curve) {
  std::size_t longest = 0;
  for (const Trial& trial : trials) longest = std::max(longest, (trial.*curve).size());
  std::vector<double> means(longest, 0.0);
  for (std::size_t view = 0; view < longest; ++view) {
    for (const Trial& trial : trials) {
      const std::vector<double>& values = trial.*curve;
      if (!values.empty()) means[view] += values[std::min(view, values.size() - 1)];
    }
    means[view] /= static_cast<double>(trials.size());
  }
  return means;
}

Json to_json(const std::optional<double>& number) { return number ? Json(*number) : Json(); }

std::string to_csv(const std::optional<double>& number) {
  return number ? support::exact_text(*number) : std::string();
}

std::size_t completed(const std::vector<Trial>& trials) {
  return static_cast<std::size_t>(
      std::ranges::count(trials, survey::StopReason::complete, &Trial::stop_reason));
}

/// Column of Table 1.
struct Column {
  const char* key;
  const char* title;
  double unit;  ///< unit of the printed values
  const char* format;
  Statistic CellFigures::*ours;
  double PaperResult::*papers;
};

std::vector<Column> columns(Times times) {
  std::vector<Column> all{
      {"views", "Views", 1.0, "{:.1f}", &CellFigures::views, &PaperResult::views},
      {"coverage", "Coverage [%]", 0.01, "{:.1f}", &CellFigures::coverage, &PaperResult::coverage},
      {"planning_time_s", "Time [s]", 1.0, "{:.3g}", &CellFigures::planning_time,
       &PaperResult::planning_time},
      {"distance_m", "Distance [m]", 1.0, "{:.1f}", &CellFigures::distance,
       &PaperResult::distance}};
  if (times == Times::left_out) {
    std::erase_if(all,
                  [](const Column& column) { return column.ours == &CellFigures::planning_time; });
  }
  return all;
}

std::string formatted(const char* format, double number) {
  return fmt::format(fmt::runtime(format), number);
}

template <typename Member>
std::vector<std::string> distinct(const std::vector<BenchmarkCell>& cells, Member member) {
  std::vector<std::string> values;
  for (const BenchmarkCell& cell : cells) {
    if (std::ranges::find(values, cell.*member) == values.end()) values.push_back(cell.*member);
  }
  return values;
}

const BenchmarkCell* find_cell(const std::vector<BenchmarkCell>& cells, const std::string& mission,
                               const std::string& planner) {
  const auto found = std::ranges::find_if(cells, [&](const BenchmarkCell& cell) {
    return cell.mission == mission && cell.planner == planner;
  });
  return found == cells.end() ? nullptr : &*found;
}

/// Coverage level at which planners are compared.
struct Mark {
  std::string key;    ///< key in results.json
  std::string title;  ///< title in the report
  double coverage;
  std::optional<CellFigures> whole;  ///< results of surveys that end at this coverage
};

/// Returns the coverage of the paper's SEE++, and of SEE++ and SEE in this benchmark.
std::vector<Mark> make_marks(const std::vector<BenchmarkCell>& cells, const std::string& mission) {
  std::vector<Mark> marks;
  if (const auto paper = paper_result(mission, "see++")) {
    marks.push_back({"paper", "the paper's SEE++", paper->coverage, {}});
  }
  for (const char* planner : {"see++", "see"}) {
    const BenchmarkCell* cell = find_cell(cells, mission, planner);
    if (!cell || cell->trials.empty()) continue;
    const CellFigures whole = compute_figures(*cell);
    marks.push_back({planner, to_title(planner) + " here", whole.coverage.mean, whole});
  }
  return marks;
}

/// Returns the statistic of a measure, or nullopt if a trial does not have it.
template <typename Figure>
std::optional<Statistic> find_statistic(const std::vector<Trial>& trials, const Figure& figure) {
  std::vector<double> numbers;
  for (const Trial& trial : trials) {
    const std::optional<double> number = figure(trial);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  if (numbers.empty()) return std::nullopt;
  return statistic(numbers);
}

/// Returns the statistic of the mean coverage over the first `views` views.
std::optional<Statistic> find_auc(const std::vector<Trial>& trials, std::size_t views) {
  return find_statistic(trials, [views](const Trial& trial) {
    return trial.coverage_after.empty() ? std::nullopt
                                        : std::optional(compute_auc(trial.coverage_after, views));
  });
}

/// Adds the measures of protocol_g.h that all trials have.
void add_protocol_g(const std::vector<Trial>& trials, Json& json) {
  const auto add = [&](Json& to, const std::string& key, const std::optional<Statistic>& known) {
    if (known) to[key] = statistic_json(*known);
  };
  add(json, "grid_coverage", find_statistic(trials, std::mem_fn(&Trial::grid_coverage)));
  add(json, "grid_coverage_visible",
      find_statistic(trials, std::mem_fn(&Trial::grid_coverage_visible)));
  add(json, "chamfer_distance_m", find_statistic(trials, std::mem_fn(&Trial::chamfer_distance)));
  for (const std::size_t views : auc_views) {
    add(json["coverage_auc"], std::to_string(views), find_auc(trials, views));
  }
}

Json to_json(const BenchmarkCell& cell, const std::vector<BenchmarkCell>& cells) {
  Json json{{"mission", cell.mission},
            {"planner", cell.planner},
            {"title", to_title(cell.planner)},
            {"trials", cell.trials.size()}};
  if (cell.trials.empty()) return json;
  json["trials_complete"] =
      std::ranges::count(cell.trials, survey::StopReason::complete, &Trial::stop_reason);
  const CellFigures figures = compute_figures(cell);
  const auto paper = paper_result(cell.mission, cell.planner);
  for (const Column& column : columns(Times::shown)) {
    const Statistic& ours = figures.*column.ours;
    json[column.key] = statistic_json(ours);
    if (!paper) continue;
    json[column.key]["paper"] = (*paper).*column.papers;
    json[column.key]["ratio_to_paper"] = ours.mean / (*paper).*column.papers;
  }
  if (figures.coverage_visible)
    json["coverage_visible"] = statistic_json(*figures.coverage_visible);
  if (figures.flight_time) json["flown_s"] = statistic_json(*figures.flight_time);
  json["attainable_coverage"] =
      figures.attainable_coverage ? Json(*figures.attainable_coverage) : Json();
  const ViewFigures per_view = view_figures(cell.trials);
  json["frontiers_per_view"] = statistic_json(per_view.frontiers);
  json["coverage_per_view"] = statistic_json(per_view.coverage);
  const TargetFigures targets = target_figures(cell.trials);
  json["targets"] = {{"observed", targets.targets},
                     {"share_by_views", targets.share_by_views},
                     {"distance_bin_m", target_distance_bin},
                     {"share_by_distance", targets.share_by_distance}};
  for (const Mark& mark : make_marks(cells, cell.mission)) {
    const auto reach = reach_figures(cell.trials, mark.coverage);
    Json& to = json["until_coverage_of"][mark.key];
    to["coverage"] = mark.coverage;
    to["trials"] = reach ? reach->reached : 0;
    if (!reach) continue;
    to["views"] = statistic_json(reach->views);
    to["distance_m"] = statistic_json(reach->distance);
    to["planning_time_s"] = statistic_json(reach->planning_time);
  }
  add_protocol_g(cell.trials, json);
  json["curves"] = curves_json(cell.trials);
  json["each_trial"] = each_trial_json(cell.trials);
  return json;
}

/// Returns the cells of planners.
std::vector<BenchmarkCell> without_sets(const std::vector<BenchmarkCell>& cells) {
  std::vector<BenchmarkCell> planned = cells;
  std::erase_if(planned, [](const BenchmarkCell& cell) { return cell.set_views.has_value(); });
  return planned;
}

Json difference_json(const std::optional<PairedDifference>& difference) {
  return difference ? statistic_json(difference->difference) : Json();
}

Json comparison_json(const UniformComparison& comparison) {
  return {{"mission", comparison.mission},
          {"planner", comparison.planner},
          {"title", to_title(comparison.planner)},
          {"views", statistic_json(comparison.views)},
          {"coverage", statistic_json(comparison.coverage)},
          {"distance_m", statistic_json(comparison.distance)},
          {"same_views", comparison.same_views},
          {"coverage_difference", difference_json(comparison.coverage_difference)},
          {"distance_difference_m", difference_json(comparison.distance_difference)},
          {"beats_uniform", comparison.beats_uniform()},
          {"verdict", comparison.verdict()},
          {"reaching_views", comparison.reaching_views ? Json(*comparison.reaching_views) : Json()},
          {"reaching_distance_m",
           comparison.reaching_distance ? statistic_json(*comparison.reaching_distance) : Json()},
          {"max_tested_views", comparison.max_tested_views}};
}

/// Returns Table 1 in the layout of the paper: one row per planner, four columns per model.
std::string table_1(const std::vector<BenchmarkCell>& cells, Times times) {
  const auto missions = distinct(cells, &BenchmarkCell::mission);
  std::vector<std::string> head{"planner"};
  for (const std::string& mission : missions) {
    for (const Column& column : columns(times)) head.push_back(mission + ": " + column.title);
  }
  std::string text = table_row(head) + table_rule(head.size());
  for (const std::string& planner : distinct(cells, &BenchmarkCell::planner)) {
    std::vector<std::string> line{to_title(planner)};
    for (const std::string& mission : missions) {
      const BenchmarkCell* cell = find_cell(cells, mission, planner);
      const auto paper = paper_result(mission, planner);
      for (const Column& column : columns(times)) {
        std::string entry = "-";
        if (cell && !cell->trials.empty()) {
          entry =
              formatted(column.format, (compute_figures(*cell).*column.ours).mean / column.unit);
        }
        if (paper) {
          entry += " (" + formatted(column.format, (*paper).*column.papers / column.unit) + ")";
        }
        line.push_back(entry);
      }
    }
    text += table_row(line);
  }
  return text;
}

std::string with_spread(const Statistic& seconds) {
  std::string entry = formatted("{:.0f}", seconds.mean);
  if (std::isfinite(seconds.half_width_95)) {
    entry += " ± " + formatted("{:.2g}", seconds.half_width_95);
  }
  return entry;
}

std::string with_certainty(const Column& column, const Statistic& ours,
                           const std::optional<PaperResult>& paper) {
  std::string entry = formatted(column.format, ours.mean / column.unit);
  if (std::isfinite(ours.half_width_95)) {
    entry += " ± " + formatted("{:.2g}", ours.half_width_95 / column.unit) + " (sd " +
             formatted("{:.2g}", ours.deviation / column.unit) + ")";
  }
  if (paper) entry += ", " + formatted("{:.2f}", ours.mean / (*paper).*column.papers) + "×";
  return entry;
}

std::string details(const std::vector<BenchmarkCell>& cells, const std::string& mission,
                    Times times) {
  std::vector<std::string> head{"planner", "trials"};
  for (const Column& column : columns(times)) head.emplace_back(column.title);
  head.insert(head.end(), {"of the visible surface [%]", "of the attainable coverage [%]",
                           "survey flight [s]"});
  std::string text = table_row(head) + table_rule(head.size());
  for (const BenchmarkCell& cell : cells) {
    if (cell.mission != mission || cell.trials.empty()) continue;
    const CellFigures figures = compute_figures(cell);
    const auto paper = paper_result(mission, cell.planner);
    std::vector<std::string> line{to_title(cell.planner), std::to_string(cell.trials.size())};
    for (const Column& column : columns(times)) {
      line.push_back(with_certainty(column, figures.*column.ours, paper));
    }
    line.push_back(figures.coverage_visible
                       ? formatted("{:.1f}", 100.0 * figures.coverage_visible->mean)
                       : "-");
    line.push_back(
        figures.attainable_coverage
            ? formatted("{:.1f}", 100.0 * figures.coverage.mean / *figures.attainable_coverage)
            : "-");
    line.push_back(figures.flight_time ? with_spread(*figures.flight_time) : "-");
    text += table_row(line);
  }
  return text;
}

/// Which planners' surveys ended at the limit of views: ratios to published results mean nothing
/// then. Volumetric surveys have as many views as SEE, as published, and are not named.
std::string cut_short_text(const std::vector<BenchmarkCell>& cells, const std::string& mission) {
  std::string text;
  for (const BenchmarkCell& cell : cells) {
    const Method* method = find_method(cell.planner);
    if (cell.mission != mission || (method != nullptr && method->has_view_limit)) continue;
    const auto cut =
        std::ranges::count(cell.trials, survey::StopReason::view_limit, &Trial::stop_reason);
    if (cut == 0) continue;
    text += fmt::format("{}{}: {} of {} surveys ended at limits.max_views",
                        text.empty() ? "" : "; ", to_title(cell.planner), cut, cell.trials.size());
  }
  return text.empty() ? "" : "\n" + text + ". Ratios to the paper compare unfinished surveys.\n";
}

/// Returns a table of each planner's effort to reach the coverage levels, with the ratio to the
/// effort of the reference planner.
std::string reach_table(const std::vector<BenchmarkCell>& cells, const std::string& mission,
                        Times times) {
  std::string text;
  for (const Mark& mark : make_marks(cells, mission)) {
    const auto entry = [&](const Column& column, const Statistic& ours) {
      std::string number = formatted(column.format, ours.mean / column.unit);
      const double whole = mark.whole ? ((*mark.whole).*column.ours).mean : 0.0;
      if (whole > 0.0) number += ", " + formatted("{:.2f}", ours.mean / whole) + "×";
      return number;
    };
    for (const BenchmarkCell& cell : cells) {
      if (cell.mission != mission || cell.planner == mark.key) continue;
      const auto reach = reach_figures(cell.trials, mark.coverage);
      std::vector<std::string> line{
          mark.title + ", " + formatted("{:.1f}", 100.0 * mark.coverage), to_title(cell.planner),
          std::to_string(reach ? reach->reached : 0) + " of " + std::to_string(cell.trials.size())};
      for (const Column& column : columns(times)) {
        if (column.ours == &CellFigures::coverage) continue;
        line.push_back(!reach                               ? "-"
                       : column.ours == &CellFigures::views ? entry(column, reach->views)
                       : column.ours == &CellFigures::distance
                           ? entry(column, reach->distance)
                           : entry(column, reach->planning_time));
      }
      text += table_row(line);
    }
  }
  if (text.empty()) return text;
  std::vector<std::string> head{"coverage of [%]", "planner", "trials that reach it"};
  for (const Column& column : columns(times)) {
    if (column.ours != &CellFigures::coverage) head.emplace_back(column.title);
  }
  return table_row(head) + table_rule(head.size()) + text;
}

/// Returns all trials of a planner on the standard models.
std::vector<Trial> standard_trials(const std::vector<BenchmarkCell>& cells,
                                   const std::string& planner) {
  std::vector<Trial> trials;
  for (const BenchmarkCell& cell : cells) {
    if (cell.planner != planner || !is_standard_model(cell.mission)) continue;
    trials.insert(trials.end(), cell.trials.begin(), cell.trials.end());
  }
  return trials;
}

std::string table_2(const std::vector<BenchmarkCell>& cells) {
  std::string text = table_row({"planner", "frontiers observed per view", "paper",
                                "coverage per view [%]", "paper"}) +
                     table_rule(5);
  for (const char* planner : {"see", "see++"}) {
    const std::vector<Trial> trials = standard_trials(cells, planner);
    if (trials.empty()) continue;
    const ViewFigures figures = view_figures(trials);
    const auto paper = paper_view_result(planner);
    text += table_row({to_title(planner), formatted("{:.2f}", figures.frontiers.mean),
                       formatted("{:.2f}", paper->frontiers),
                       formatted("{:.2f}", 100.0 * figures.coverage.mean),
                       formatted("{:.2f}", 100.0 * paper->coverage)});
  }
  return text;
}

std::string figure_6(const std::vector<BenchmarkCell>& cells) {
  constexpr double quoted_distance = 3.0;  // distance stated in the paper's text [m]
  const auto bin = static_cast<std::size_t>(quoted_distance / target_distance_bin) - 1;
  std::string text =
      table_row({"planner", "targets observed", "with a single view [%]", "within 3 m [%]"}) +
      table_rule(4);
  for (const char* planner : {"see", "see++"}) {
    const TargetFigures figures = target_figures(standard_trials(cells, planner));
    if (figures.targets == 0) continue;
    text += table_row({to_title(planner), std::to_string(figures.targets),
                       formatted("{:.1f}", 100.0 * figures.share_by_views.front()),
                       formatted("{:.1f}", 100.0 * figures.share_by_distance[bin])});
  }
  return text;
}

}  // namespace

std::string trials_csv(const std::vector<Trial>& trials, Times times) {
  const bool has_times = times == Times::shown;
  std::string csv =
      "seed,stop_reason,views,coverage,coverage_visible,attainable_coverage,distance_m,points,"
      "flown_m,"
      "flown_s";
  csv += has_times ? ",planning_time_s\n" : "\n";
  for (const Trial& trial : trials) {
    csv += std::to_string(trial.seed) + "," + session::to_string(trial.stop_reason) + "," +
           std::to_string(trial.views) + "," + support::exact_text(trial.coverage.all) + "," +
           to_csv(trial.coverage.visible) + "," + to_csv(trial.coverage.attainable_coverage) + "," +
           support::exact_text(trial.distance) + "," + std::to_string(trial.points) + "," +
           to_csv(trial.flight_length) + "," + to_csv(trial.flight_time());
    csv += has_times ? "," + support::exact_text(trial.planning_time) + "\n" : "\n";
  }
  return csv;
}

std::string trials_json(const config::MissionSetup& mission, const std::vector<Trial>& trials,
                        std::size_t requested, unsigned threads) {
  Json json{{"mission", mission.name},
            {"planner", survey::find_title(mission.survey().planner.name).word},
            {"title", survey::find_title(mission.survey().planner.name).title},
            {"preset", mission.text("planner.preset")},
            {"first_seed", mission.run.seed},
            {"threads", geometry::thread_count(threads)},
            {"version", version},
            {"complete", trials.size() == requested},
            {"trials_requested", requested},
            {"trials", trials.size()},
            {"trials_complete", completed(trials)},
            {"attainable_coverage",
             trials.empty() ? Json() : to_json(trials[0].coverage.attainable_coverage)}};
  if (trials.empty()) return support::json_text(json);
  for (const Figure& figure : trial_figures) {
    json[figure.name] = statistic_json(compute_statistic(trials, figure));
    if (const auto reference = find_reference(mission, figure)) {
      json[figure.name]["paper"] = *reference;
    }
  }
  if (std::ranges::all_of(trials, &Trial::has_vehicle)) {
    json["flown_s"] = statistic_json(
        compute_statistic(trials, {"", [](const Trial& t) { return *t.flight_time(); }, {}, {}}));
  }
  json["mean_after_view"] = {{"coverage", mean_curve(trials, &Trial::coverage_after)},
                             {"distance_m", mean_curve(trials, &Trial::distance_after)}};
  json["curves"] = curves_json(trials);
  json["each_trial"] = each_trial_json(trials);
  return support::json_text(json);
}

std::string trials_table(const config::MissionSetup& mission, const std::vector<Trial>& trials) {
  if (trials.empty()) return "";
  std::string table =
      fmt::format("{}: {} trials, {} complete\n{:<18} {:>12} {:>10} {:>10} {:>12}\n", mission.name,
                  trials.size(), completed(trials), "", "mean", "+- (95 %)", "sd", "paper");
  for (const Figure& figure : trial_figures) {
    const Statistic statistic = compute_statistic(trials, figure);
    const auto reference = find_reference(mission, figure);
    table += fmt::format("{:<18} {:12.4g} {:10.2g} {:10.2g} {:>12}\n", figure.name, statistic.mean,
                         statistic.half_width_95, statistic.deviation,
                         reference ? fmt::format("{:.4g}", *reference) : "-");
  }
  return table;
}

std::string results_json(const std::vector<BenchmarkCell>& all) {
  const std::vector<BenchmarkCell> cells = without_sets(all);
  Json json{{"version", version}, {"results", Json::array()}};
  for (const BenchmarkCell& cell : cells) json["results"].push_back(to_json(cell, cells));
  if (cells.size() == all.size()) return support::json_text(json);
  json["uniform_comparison"] = Json::array();
  for (const UniformComparison& comparison : compare_with_uniform(all)) {
    json["uniform_comparison"].push_back(comparison_json(comparison));
  }
  json["fixed_views"] = Json::array();
  for (const BenchmarkCell& cell : all) {
    if (!cell.set_views || cell.trials.empty()) continue;
    const CellFigures figures = compute_figures(cell);
    json["fixed_views"].push_back({{"mission", cell.mission},
                                   {"planner", cell.planner},
                                   {"views", *cell.set_views},
                                   {"trials", cell.trials.size()},
                                   {"coverage", statistic_json(figures.coverage)},
                                   {"distance_m", statistic_json(figures.distance)},
                                   {"each_trial", each_trial_json(cell.trials)}});
    add_protocol_g(cell.trials, json["fixed_views"].back());
  }
  return support::json_text(json);
}

std::string table_1_csv(const std::vector<BenchmarkCell>& cells, Times times) {
  std::string csv = "mission,planner,trials";
  for (const Column& column : columns(times)) {
    for (const char* part : {"", "_sd", "_half_width_95", "_paper", "_ratio"}) {
      csv += std::string(",") + column.key + part;
    }
  }
  csv += ",coverage_visible,attainable_coverage\n";
  for (const BenchmarkCell& cell : cells) {
    if (cell.trials.empty()) continue;
    const CellFigures figures = compute_figures(cell);
    const auto paper = paper_result(cell.mission, cell.planner);
    csv += cell.mission + "," + cell.planner + "," + std::to_string(cell.trials.size());
    for (const Column& column : columns(times)) {
      const Statistic& ours = figures.*column.ours;
      csv += "," + support::exact_text(ours.mean) + "," + support::exact_text(ours.deviation) + ",";
      if (std::isfinite(ours.half_width_95)) csv += support::exact_text(ours.half_width_95);
      csv += paper ? "," + support::exact_text((*paper).*column.papers) + "," +
                         support::exact_text(ours.mean / (*paper).*column.papers)
                   : ",,";
    }
    csv +=
        "," + (figures.coverage_visible ? support::exact_text(figures.coverage_visible->mean) : "");
    csv += "," +
           (figures.attainable_coverage ? support::exact_text(*figures.attainable_coverage) : "") +
           "\n";
  }
  return csv;
}

std::string all_trials_csv(const std::vector<BenchmarkCell>& cells, Times times) {
  std::string csv;
  for (const BenchmarkCell& cell : cells) {
    const std::string lines = trials_csv(cell.trials, times);
    const std::size_t header_end = lines.find('\n') + 1;
    if (csv.empty()) csv = "mission,planner," + lines.substr(0, header_end);
    for (std::size_t begin = header_end; begin < lines.size();) {
      const std::size_t end = lines.find('\n', begin) + 1;
      csv += cell.mission + "," + cell.planner +
             (cell.set_views ? "_" + std::to_string(*cell.set_views) : "") + "," +
             lines.substr(begin, end - begin);
      begin = end;
    }
  }
  return csv;
}

/// Returns the table of the measures of protocol_g.h, or an empty string if no cell has them.
std::string protocol_g_markdown(const std::vector<BenchmarkCell>& cells) {
  std::vector<std::string> head{"planner", "mission"};
  for (const std::size_t views : auc_views) {
    head.push_back("AUC over " + std::to_string(views) + " views [%]");
  }
  head.insert(head.end(),
              {"grid coverage [%]", "grid coverage, visible cells [%]", "Chamfer distance [mm]"});
  const auto scaled = [](const std::optional<Statistic>& known, const char* format, double factor) {
    return known ? formatted(format, factor * known->mean) : std::string("-");
  };
  std::string lines;
  for (const BenchmarkCell& cell : cells) {
    const auto grid = find_statistic(cell.trials, std::mem_fn(&Trial::grid_coverage));
    if (!grid) continue;
    std::vector<std::string> line{to_title(cell.planner), cell.mission};
    for (const std::size_t views : auc_views) {
      line.push_back(scaled(find_auc(cell.trials, views), "{:.1f}", 100.0));
    }
    line.push_back(scaled(grid, "{:.1f}", 100.0));
    line.push_back(scaled(find_statistic(cell.trials, std::mem_fn(&Trial::grid_coverage_visible)),
                          "{:.1f}", 100.0));
    line.push_back(scaled(find_statistic(cell.trials, std::mem_fn(&Trial::chamfer_distance)),
                          "{:.2f}", 1000.0));
    lines += table_row(line);
  }
  if (lines.empty()) return "";
  return "\n"
         "## Measures of the GenNBV protocol\n"
         "\n"
         "AUC: mean coverage over the first views; a survey that ends earlier keeps its last "
         "value. Grid coverage: fraction of the occupied cells of a 20 x 20 x 20 grid with a "
         "measured point. Chamfer distance: of points rounded to 1 cm.\n"
         "\n" +
         table_row(head) + table_rule(head.size()) + lines;
}

std::string report_markdown(const std::vector<BenchmarkCell>& all, const std::string& title,
                            Times times) {
  const std::vector<BenchmarkCell> cells = without_sets(all);
  std::string text = "# " + title +
                     "\n"
                     "\n"
                     "Means over the trials, with the values of the SEE++ paper (100 trials) in "
                     "brackets. The symbol ± precedes the half width of the 95% confidence "
                     "interval of the mean, and × precedes the ratio to the paper. sd: standard "
                     "deviation over the trials. Definitions: docs/howto/compare-planners.md.\n" +
                     uniform_markdown(all) + pattern_markdown(cells) +
                     "\n"
                     "## Table 1\n"
                     "\n" +
                     table_1(cells, times);
  for (const std::string& mission : distinct(cells, &BenchmarkCell::mission)) {
    text += "\n### " + mission + "\n\n" + details(cells, mission, times) +
            cut_short_text(cells, mission);
    const std::string reach = reach_table(cells, mission, times);
    if (!reach.empty())
      text +=
          "\n"
          "Effort to reach a given coverage. The symbol × precedes the ratio to the complete "
          "survey:\n"
          "\n" +
          reach;
  }
  const auto has_standard_see = [](const BenchmarkCell& cell) {
    return is_standard_model(cell.mission) && paper_view_result(cell.planner) &&
           !cell.trials.empty();
  };
  if (std::ranges::any_of(cells, has_standard_see)) {
    text +=
        "\n"
        "## Table 2\n"
        "\n"
        "Means per view over the standard models.\n"
        "\n" +
        table_2(cells) +
        "\n"
        "## Figure 6\n"
        "\n"
        "Effort until the target frontier of a view is observed.\n"
        "\n" +
        figure_6(cells);
  }
  return text + protocol_g_markdown(cells);
}

std::string stage_tables(const std::vector<BenchmarkCell>& cells, const std::string& title,
                         Times times, geometry::OutputFolder& folder) {
  folder.write("trials.csv", all_trials_csv(cells, times));
  const std::vector<BenchmarkCell> planned = without_sets(cells);
  folder.write("table1.csv", table_1_csv(planned, times));
  folder.write("results.json", results_json(cells));
  folder.write("curves.csv", curves_csv(planned, times));
  folder.write("curves.svg", curves_svg(planned, times));
  std::string markdown = report_markdown(cells, title, times);
  folder.write("report.md", markdown);
  return markdown;
}

std::string times_csv(const std::vector<ItemTimes>& items) {
  std::string csv = "item,host,wall_time_s,planning_time_s,peak_memory_bytes\n";
  for (const ItemTimes& item : items) {
    csv += std::to_string(item.number) + "," + item.run.host + "," +
           support::exact_text(item.run.wall_time) + "," + support::exact_text(item.planning_time) +
           "," + std::to_string(item.run.peak_memory) + "\n";
  }
  return csv;
}

}  // namespace skycap::missions::batch
