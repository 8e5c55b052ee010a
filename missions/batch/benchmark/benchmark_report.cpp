#include "missions/batch/benchmark/benchmark_report.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "missions/batch/benchmark/contestants.h"
#include "missions/batch/benchmark/paper_results.h"
#include "missions/batch/benchmark/trial_json.h"
#include "missions/support/json_text.h"
#include "missions/support/number_text.h"
#include "missions/version.h"

namespace skycap::missions::batch {
namespace {

using Json = nlohmann::ordered_json;

/// The four figures of Table 1.
struct Column {
  const char* key;
  const char* title;
  double unit;  ///< what a printed figure is a multiple of
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

std::string title_of(const std::string& planner) {
  const Contestant* contestant = find_contestant(planner);
  return contestant ? contestant->title : planner;
}

template <typename Member>
std::vector<std::string> distinct(const std::vector<BenchmarkCell>& cells, Member member) {
  std::vector<std::string> values;
  for (const BenchmarkCell& cell : cells) {
    if (std::ranges::find(values, cell.*member) == values.end()) values.push_back(cell.*member);
  }
  return values;
}

const BenchmarkCell* cell_of(const std::vector<BenchmarkCell>& cells, const std::string& mission,
                             const std::string& planner) {
  const auto found = std::ranges::find_if(cells, [&](const BenchmarkCell& cell) {
    return cell.mission == mission && cell.planner == planner;
  });
  return found == cells.end() ? nullptr : &*found;
}

/// A coverage that planners are timed to.
struct Mark {
  std::string key;    ///< in results.json
  std::string title;  ///< in the report
  double coverage;
  std::optional<CellFigures> whole;  ///< surveys that end with it
};

/// The paper's SEE++, and SEE++ and SEE as they are here.
std::vector<Mark> marks_of(const std::vector<BenchmarkCell>& cells, const std::string& mission) {
  std::vector<Mark> marks;
  if (const auto paper = paper_result(mission, "see++")) {
    marks.push_back({"paper", "the paper's SEE++", paper->coverage, {}});
  }
  for (const char* planner : {"see++", "see"}) {
    const BenchmarkCell* cell = cell_of(cells, mission, planner);
    if (!cell || cell->trials.empty()) continue;
    const CellFigures whole = figures_of(*cell);
    marks.push_back({planner, title_of(planner) + " here", whole.coverage.mean, whole});
  }
  return marks;
}

Json json_of(const BenchmarkCell& cell, const std::vector<BenchmarkCell>& cells) {
  Json json{{"mission", cell.mission},
            {"planner", cell.planner},
            {"title", title_of(cell.planner)},
            {"trials", cell.trials.size()}};
  if (cell.trials.empty()) return json;
  json["trials_complete"] =
      std::ranges::count(cell.trials, survey::StopReason::complete, &Trial::stop_reason);
  const CellFigures figures = figures_of(cell);
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
  if (figures.flown_time) json["flown_s"] = statistic_json(*figures.flown_time);
  json["attainable_coverage"] = figures.ceiling ? Json(*figures.ceiling) : Json();
  const ViewFigures per_view = view_figures(cell.trials);
  json["frontiers_per_view"] = statistic_json(per_view.frontiers);
  json["coverage_per_view"] = statistic_json(per_view.coverage);
  const TargetFigures targets = target_figures(cell.trials);
  json["targets"] = {{"observed", targets.targets},
                     {"share_by_views", targets.share_by_views},
                     {"distance_bin_m", target_distance_bin},
                     {"share_by_distance", targets.share_by_distance}};
  for (const Mark& mark : marks_of(cells, cell.mission)) {
    const auto reach = reach_figures(cell.trials, mark.coverage);
    Json& to = json["until_coverage_of"][mark.key];
    to["coverage"] = mark.coverage;
    to["trials"] = reach ? reach->reached : 0;
    if (!reach) continue;
    to["views"] = statistic_json(reach->views);
    to["distance_m"] = statistic_json(reach->distance);
    to["planning_time_s"] = statistic_json(reach->planning_time);
  }
  json["curves"] = curves_json(cell.trials);
  json["each_trial"] = each_trial_json(cell.trials);
  return json;
}

/// A row of a Markdown table.
std::string row(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

std::string rule(std::size_t columns) {
  std::string text = "| --- |";
  for (std::size_t i = 1; i < columns; ++i) text += " ---: |";
  return text + "\n";
}

/// Table 1 as printed: a row for each planner, four columns for each model.
std::string table_1(const std::vector<BenchmarkCell>& cells, Times times) {
  const auto missions = distinct(cells, &BenchmarkCell::mission);
  std::vector<std::string> head{"planner"};
  for (const std::string& mission : missions) {
    for (const Column& column : columns(times)) head.push_back(mission + ": " + column.title);
  }
  std::string text = row(head) + rule(head.size());
  for (const std::string& planner : distinct(cells, &BenchmarkCell::planner)) {
    std::vector<std::string> line{title_of(planner)};
    for (const std::string& mission : missions) {
      const BenchmarkCell* cell = cell_of(cells, mission, planner);
      const auto paper = paper_result(mission, planner);
      for (const Column& column : columns(times)) {
        std::string entry = "-";
        if (cell && !cell->trials.empty()) {
          entry = formatted(column.format, (figures_of(*cell).*column.ours).mean / column.unit);
        }
        if (paper) {
          entry += " (" + formatted(column.format, (*paper).*column.papers / column.unit) + ")";
        }
        line.push_back(entry);
      }
    }
    text += row(line);
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
  std::string text = row(head) + rule(head.size());
  for (const BenchmarkCell& cell : cells) {
    if (cell.mission != mission || cell.trials.empty()) continue;
    const CellFigures figures = figures_of(cell);
    const auto paper = paper_result(mission, cell.planner);
    std::vector<std::string> line{title_of(cell.planner), std::to_string(cell.trials.size())};
    for (const Column& column : columns(times)) {
      line.push_back(with_certainty(column, figures.*column.ours, paper));
    }
    line.push_back(figures.coverage_visible
                       ? formatted("{:.1f}", 100.0 * figures.coverage_visible->mean)
                       : "-");
    line.push_back(figures.ceiling
                       ? formatted("{:.1f}", 100.0 * figures.coverage.mean / *figures.ceiling)
                       : "-");
    line.push_back(figures.flown_time ? with_spread(*figures.flown_time) : "-");
    text += row(line);
  }
  return text;
}

/// What it takes each planner to come to the coverage of others, and the ratio to what it took
/// them.
std::string reach_table(const std::vector<BenchmarkCell>& cells, const std::string& mission,
                        Times times) {
  std::string text;
  for (const Mark& mark : marks_of(cells, mission)) {
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
          mark.title + ", " + formatted("{:.1f}", 100.0 * mark.coverage), title_of(cell.planner),
          std::to_string(reach ? reach->reached : 0) + " of " + std::to_string(cell.trials.size())};
      for (const Column& column : columns(times)) {
        if (column.ours == &CellFigures::coverage) continue;
        line.push_back(!reach                               ? "-"
                       : column.ours == &CellFigures::views ? entry(column, reach->views)
                       : column.ours == &CellFigures::distance
                           ? entry(column, reach->distance)
                           : entry(column, reach->planning_time));
      }
      text += row(line);
    }
  }
  if (text.empty()) return text;
  std::vector<std::string> head{"coverage of [%]", "planner", "trials that reach it"};
  for (const Column& column : columns(times)) {
    if (column.ours != &CellFigures::coverage) head.emplace_back(column.title);
  }
  return row(head) + rule(head.size()) + text;
}

/// All trials of a planner on the standard models.
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
  std::string text =
      row({"planner", "frontiers observed per view", "paper", "coverage per view [%]", "paper"}) +
      rule(5);
  for (const char* planner : {"see", "see++"}) {
    const std::vector<Trial> trials = standard_trials(cells, planner);
    if (trials.empty()) continue;
    const ViewFigures figures = view_figures(trials);
    const auto paper = paper_view_result(planner);
    text += row({title_of(planner), formatted("{:.2f}", figures.frontiers.mean),
                 formatted("{:.2f}", paper->frontiers),
                 formatted("{:.2f}", 100.0 * figures.coverage.mean),
                 formatted("{:.2f}", 100.0 * paper->coverage)});
  }
  return text;
}

std::string figure_6(const std::vector<BenchmarkCell>& cells) {
  constexpr double quoted_distance = 3.0;  // what the paper's text gives
  const auto bin = static_cast<std::size_t>(quoted_distance / target_distance_bin) - 1;
  std::string text =
      row({"planner", "targets observed", "with a single view [%]", "within 3 m [%]"}) + rule(4);
  for (const char* planner : {"see", "see++"}) {
    const TargetFigures figures = target_figures(standard_trials(cells, planner));
    if (figures.targets == 0) continue;
    text += row({title_of(planner), std::to_string(figures.targets),
                 formatted("{:.1f}", 100.0 * figures.share_by_views.front()),
                 formatted("{:.1f}", 100.0 * figures.share_by_distance[bin])});
  }
  return text;
}

}  // namespace

std::string results_json(const std::vector<BenchmarkCell>& cells) {
  Json json{{"version", version}, {"results", Json::array()}};
  for (const BenchmarkCell& cell : cells) json["results"].push_back(json_of(cell, cells));
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
    const CellFigures figures = figures_of(cell);
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
    csv += "," + (figures.ceiling ? support::exact_text(*figures.ceiling) : "") + "\n";
  }
  return csv;
}

std::string all_trials_csv(const std::vector<BenchmarkCell>& cells, Times times) {
  std::string csv;
  for (const BenchmarkCell& cell : cells) {
    const std::string lines = trials_csv(cell.trials, times);
    const std::size_t end_of_head = lines.find('\n') + 1;
    if (csv.empty()) csv = "mission,planner," + lines.substr(0, end_of_head);
    for (std::size_t begin = end_of_head; begin < lines.size();) {
      const std::size_t end = lines.find('\n', begin) + 1;
      csv += cell.mission + "," + cell.planner + "," + lines.substr(begin, end - begin);
      begin = end;
    }
  }
  return csv;
}

std::string report_markdown(const std::vector<BenchmarkCell>& cells, const std::string& title,
                            Times times) {
  std::string text =
      "# " + title +
      "\n\nMeans over the trials; in brackets the SEE++ paper's (100 trials). ± is the half width "
      "of the 95% interval of the mean, sd the standard deviation over the trials. × is the ratio "
      "to the paper. Definitions: docs/howto/compare-planners.md.\n\n## Table 1\n\n" +
      table_1(cells, times);
  for (const std::string& mission : distinct(cells, &BenchmarkCell::mission)) {
    text += "\n### " + mission + "\n\n" + details(cells, mission, times);
    const std::string reach = reach_table(cells, mission, times);
    if (!reach.empty())
      text += "\nUntil a coverage is reached; × is the ratio to the whole survey:\n\n" + reach;
  }
  const auto has_standard_see = [](const BenchmarkCell& cell) {
    return is_standard_model(cell.mission) && paper_view_result(cell.planner) &&
           !cell.trials.empty();
  };
  if (std::ranges::any_of(cells, has_standard_see)) {
    text += "\n## Table 2\n\nPer view, over the standard models.\n\n" + table_2(cells) +
            "\n## Figure 6\n\nTarget frontiers of views, until one was observed.\n\n" +
            figure_6(cells);
  }
  return text;
}

}  // namespace skycap::missions::batch
