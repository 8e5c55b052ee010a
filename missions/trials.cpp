#include "missions/trials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>

#include <boost/math/distributions/students_t.hpp>
#include <nlohmann/json.hpp>

#include "geometry/parallel.h"
#include "missions/coverage.h"
#include "missions/json_text.h"
#include "missions/mission_keys.h"
#include "missions/number_text.h"
#include "missions/version.h"

namespace skycap::missions {
namespace {

using Json = nlohmann::ordered_json;

/// One of the figures that trials are compared by.
struct Figure {
  const char* name;
  double (*of)(const Trial&);
  std::optional<double> ReferenceConfig::*reference;  ///< or null
};

constexpr std::array figures{
    Figure{"views", [](const Trial& t) { return static_cast<double>(t.views); },
           &ReferenceConfig::views},
    Figure{"coverage", [](const Trial& t) { return t.coverage.all; }, &ReferenceConfig::coverage},
    // No reference: publications do not say which surface cannot be seen.
    Figure{"coverage_visible", [](const Trial& t) { return t.coverage.visible.value_or(0.0); },
           nullptr},
    Figure{"distance_m", [](const Trial& t) { return t.distance; }, &ReferenceConfig::distance},
    Figure{"planning_time_s", [](const Trial& t) { return t.planning_time; },
           &ReferenceConfig::planning_time}};

std::optional<double> reference_of(const Mission& mission, const Figure& figure) {
  return figure.reference ? mission.paper.*figure.reference : std::nullopt;
}

Statistic statistic_of(const std::vector<Trial>& trials, const Figure& figure) {
  std::vector<double> numbers;
  for (const Trial& trial : trials) numbers.push_back(figure.of(trial));
  return statistic(numbers);
}

Trial trial_of(const SurveyRecord& record, std::span<const std::uint8_t> is_visible,
               std::optional<double> ceiling) {
  Trial trial{
      .seed = record.seed,
      .stop_reason = record.stop_reason,
      .coverage = {record.coverage(), covered_share(record.is_covered, is_visible), ceiling},
      .views = record.views.size(),
      .points = record.cloud.size(),
      .planning_time = record.planning_time(),
      .distance = record.distance(),
      .coverage_after = {},
      .distance_after = {}};
  for (const JudgedView& view : record.views) {
    trial.coverage_after.push_back(view.coverage);
    trial.distance_after.push_back(view.surveyed.distance);
  }
  return trial;
}

/// The mean over the trials of a curve at each view; a trial that has ended stays at its end.
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

Json json_of(const Statistic& statistic) {
  Json json{{"mean", statistic.mean}, {"standard_deviation", statistic.deviation}};
  // JSON has no infinity: one trial says nothing about the mean's certainty.
  json["half_width_95"] =
      std::isfinite(statistic.half_width_95) ? Json(statistic.half_width_95) : Json();
  return json;
}

Json json_of(const std::optional<double>& number) { return number ? Json(*number) : Json(); }

std::string csv_of(const std::optional<double>& number) {
  return number ? exact_text(*number) : std::string();
}

std::size_t completed(const std::vector<Trial>& trials) {
  return static_cast<std::size_t>(
      std::ranges::count(trials, survey::StopReason::complete, &Trial::stop_reason));
}

}  // namespace

Statistic statistic(const std::vector<double>& numbers) {
  const auto count = static_cast<double>(numbers.size());
  double sum = 0.0, squares = 0.0;
  for (const double number : numbers) sum += number;
  const double mean = sum / count;
  if (numbers.size() < 2) return {mean, 0.0, std::numeric_limits<double>::infinity()};
  for (const double number : numbers) squares += (number - mean) * (number - mean);
  const double deviation = std::sqrt(squares / (count - 1.0));
  const double t = boost::math::quantile(boost::math::students_t(count - 1.0), 0.975);
  return {mean, deviation, t * deviation / std::sqrt(count)};
}

std::vector<Trial> run_trials(const Mission& mission, const SurveyScene& scene, std::size_t count,
                              unsigned threads, std::stop_token stop,
                              const std::function<void(const Trial&)>& report) {
  const std::vector<std::uint8_t> is_visible = scene.visible(threads);
  const std::optional<double> ceiling = scene.ceiling(is_visible, threads);
  std::vector<std::optional<Trial>> slots(count);
  std::mutex reporting;
  geometry::parallel_for(count, threads, [&](std::size_t i) {
    if (stop.stop_requested()) return;
    const SurveyRecord record = run_survey(mission, scene, mission.seed + i, 1, stop);
    if (record.stop_reason == survey::StopReason::interrupted) return;
    slots[i] = trial_of(record, is_visible, ceiling);
    if (!report) return;
    const std::lock_guard lock(reporting);
    report(*slots[i]);
  });
  std::vector<Trial> trials;
  for (std::optional<Trial>& trial : slots) {
    if (trial) trials.push_back(std::move(*trial));
  }
  return trials;
}

std::string trials_csv(const std::vector<Trial>& trials) {
  std::string csv =
      "seed,stop_reason,views,coverage,coverage_visible,coverage_ceiling,distance_m,points,"
      "planning_time_s\n";
  for (const Trial& trial : trials) {
    csv += std::to_string(trial.seed) + "," + name_of(trial.stop_reason) + "," +
           std::to_string(trial.views) + "," + exact_text(trial.coverage.all) + "," +
           csv_of(trial.coverage.visible) + "," + csv_of(trial.coverage.ceiling) + "," +
           exact_text(trial.distance) + "," + std::to_string(trial.points) + "," +
           exact_text(trial.planning_time) + "\n";
  }
  return csv;
}

std::string trials_json(const Mission& mission, const std::vector<Trial>& trials,
                        std::size_t requested, unsigned threads) {
  Json json{{"mission", mission.name},
            {"planner", to_text(*find_key("planner.name")->get(mission))},
            {"preset", to_text(*find_key("planner.preset")->get(mission))},
            {"first_seed", mission.seed},
            {"threads", geometry::thread_count(threads)},
            {"version", version},
            {"trials_requested", requested},
            {"trials", trials.size()},
            {"trials_complete", completed(trials)},
            {"coverage_ceiling", trials.empty() ? Json() : json_of(trials[0].coverage.ceiling)}};
  if (trials.empty()) return json_text(json);
  for (const Figure& figure : figures) {
    json[figure.name] = json_of(statistic_of(trials, figure));
    if (const auto reference = reference_of(mission, figure)) {
      json[figure.name]["paper"] = *reference;
    }
  }
  json["mean_after_view"] = {{"coverage", mean_curve(trials, &Trial::coverage_after)},
                             {"distance_m", mean_curve(trials, &Trial::distance_after)}};
  return json_text(json);
}

std::string trials_table(const Mission& mission, const std::vector<Trial>& trials) {
  if (trials.empty()) return "";
  std::string table;
  char line[160];
  std::snprintf(line, sizeof line, "%s: %zu trials, %zu complete\n", mission.name.c_str(),
                trials.size(), completed(trials));
  table += line;
  std::snprintf(line, sizeof line, "%-18s %12s %10s %10s %12s\n", "", "mean", "+- (95 %)", "sd",
                "paper");
  table += line;
  for (const Figure& figure : figures) {
    const Statistic statistic = statistic_of(trials, figure);
    const auto reference = reference_of(mission, figure);
    char paper[32] = "-";
    if (reference) std::snprintf(paper, sizeof paper, "%.4g", *reference);
    std::snprintf(line, sizeof line, "%-18s %12.4g %10.2g %10.2g %12s\n", figure.name,
                  statistic.mean, statistic.half_width_95, statistic.deviation, paper);
    table += line;
  }
  return table;
}

}  // namespace skycap::missions
