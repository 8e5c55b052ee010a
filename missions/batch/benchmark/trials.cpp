#include "missions/batch/benchmark/trials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/json.h"
#include "geometry/parallel.h"
#include "missions/batch/benchmark/paper_results.h"
#include "missions/batch/benchmark/trial_json.h"
#include "missions/evaluation/coverage.h"
#include "missions/package/former_fields.h"
#include "missions/support/json_text.h"
#include "missions/support/number_text.h"
#include "missions/version.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::batch {
namespace {

using Json = nlohmann::ordered_json;

/// One of the figures that trials are compared by.
struct Figure {
  const char* name;
  double (*of)(const Trial&);
  std::optional<double> config::ReferenceResults::*reference;  ///< or null
  double PaperResult::*in_table_1;                             ///< or null
};

constexpr std::array figures{
    Figure{"views", [](const Trial& t) { return static_cast<double>(t.views); },
           &config::ReferenceResults::views, &PaperResult::views},
    Figure{"coverage", [](const Trial& t) { return t.coverage.all; },
           &config::ReferenceResults::coverage, &PaperResult::coverage},
    // No reference: publications do not say which surface cannot be seen.
    Figure{"coverage_visible", [](const Trial& t) { return t.coverage.visible.value_or(0.0); },
           nullptr, nullptr},
    Figure{"distance_m", [](const Trial& t) { return t.distance; },
           &config::ReferenceResults::distance, &PaperResult::distance},
    Figure{"planning_time_s", [](const Trial& t) { return t.planning_time; },
           &config::ReferenceResults::planning_time, &PaperResult::planning_time}};

/// What the mission says of a publication, or else what the SEE++ paper has of its model.
std::optional<double> reference_of(const config::MissionSetup& mission, const Figure& figure) {
  if (figure.reference == nullptr) return std::nullopt;
  if (const auto& given = mission.reference.*figure.reference) return given;
  const auto paper =
      paper_result(mission.name, survey::title_of(mission.survey().planner.name).word);
  return paper ? std::optional((*paper).*figure.in_table_1) : std::nullopt;
}

Statistic statistic_of(const std::vector<Trial>& trials, const Figure& figure) {
  std::vector<double> numbers;
  numbers.reserve(trials.size());
  for (const Trial& trial : trials) numbers.push_back(figure.of(trial));
  return statistic(numbers);
}

std::vector<ObservedTarget> observed_targets(const std::vector<session::JudgedView>& views) {
  std::vector<ObservedTarget> observed;
  ObservedTarget current;
  double distance_before = 0.0;
  for (const session::JudgedView& view : views) {
    const double way = view.surveyed.distance - distance_before;
    distance_before = view.surveyed.distance;
    const std::optional<bool>& is_resolved = view.surveyed.step.target_resolved;
    if (!is_resolved) continue;  // the first view has no target
    ++current.views;
    current.distance += way;
    if (!*is_resolved) continue;
    observed.push_back(current);
    current = {};
  }
  return observed;
}

std::optional<double> optional_number(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
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

Json json_of(const std::optional<double>& number) { return number ? Json(*number) : Json(); }

std::string csv_of(const std::optional<double>& number) {
  return number ? support::exact_text(*number) : std::string();
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

SceneTruth scene_truth(const evaluation::SurveyScene& scene, unsigned threads,
                       const std::stop_token& stop) {
  SceneTruth truth{scene.visible(threads, stop), {}};
  if (const auto marks = scene.attainable(truth.is_visible, threads, stop)) {
    truth.ceiling = evaluation::marked_share(*marks);
  }
  return truth;
}

Trial trial_of(const session::SurveyRecord& record, const SceneTruth& truth) {
  Trial trial;
  trial.seed = record.seed;
  trial.stop_reason = record.stop_reason;
  trial.coverage = {record.coverage(),
                    evaluation::covered_share(record.is_covered, truth.is_visible), truth.ceiling};
  trial.views = record.views.size();
  trial.points = record.cloud.size();
  trial.distance = record.distance();
  for (const session::JudgedView& view : record.views) {
    trial.planning_time += view.surveyed.planning_processor_time;
    trial.coverage_after.push_back(view.coverage);
    trial.distance_after.push_back(view.surveyed.distance);
    trial.planning_time_after.push_back(trial.planning_time);
    trial.frontiers_resolved += view.surveyed.step.frontiers_resolved;
  }
  trial.targets = observed_targets(record.views);
  if (record.flown) {
    trial.flown_length = record.flown->length();
    trial.flown_time_after = record.flown->times;
  }
  return trial;
}

std::string trial_json(const Trial& trial) {
  Json json{{"seed", trial.seed},
            {"stop_reason", session::name_of(trial.stop_reason)},
            {"coverage", trial.coverage.all},
            {"coverage_visible", json_of(trial.coverage.visible)},
            {"attainable_coverage", json_of(trial.coverage.ceiling)},
            {"views", trial.views},
            {"points", trial.points},
            {"planning_time_s", trial.planning_time},
            {"distance_m", trial.distance},
            {"flown_m", json_of(trial.flown_length)},
            {"flown_s", json_of(trial.flown_time())},
            {"frontiers_resolved", trial.frontiers_resolved},
            {"coverage_after", trial.coverage_after},
            {"distance_after_m", trial.distance_after},
            {"planning_time_after_s", trial.planning_time_after},
            {"flown_after_s", trial.flown_time_after},
            {"targets", Json::array()}};
  for (const ObservedTarget& target : trial.targets) {
    json["targets"].push_back({target.views, target.distance});
  }
  return support::json_text(json);
}

Trial parse_trial(const std::string& text) {
  try {
    Json json = geometry::parse_json<Json>(text);
    package::use_current_fields(json);
    Trial trial;
    trial.seed = json.at("seed").get<std::uint64_t>();
    trial.stop_reason = session::stop_reason_named(json.at("stop_reason").get<std::string>());
    trial.coverage = {json.at("coverage").get<double>(),
                      optional_number(json.at("coverage_visible")),
                      optional_number(json.at("attainable_coverage"))};
    trial.views = json.at("views").get<std::size_t>();
    trial.points = json.at("points").get<std::size_t>();
    trial.planning_time = json.at("planning_time_s").get<double>();
    trial.distance = json.at("distance_m").get<double>();
    trial.flown_length = optional_number(json.at("flown_m"));
    trial.frontiers_resolved = json.at("frontiers_resolved").get<std::size_t>();
    trial.coverage_after = json.at("coverage_after").get<std::vector<double>>();
    trial.distance_after = json.at("distance_after_m").get<std::vector<double>>();
    trial.planning_time_after = json.at("planning_time_after_s").get<std::vector<double>>();
    trial.flown_time_after = json.at("flown_after_s").get<std::vector<double>>();
    for (const Json& target : json.at("targets")) {
      trial.targets.push_back({target.at(0).get<std::size_t>(), target.at(1).get<double>()});
    }
    return trial;
  } catch (const nlohmann::json::exception& failure) {
    throw Error(ErrorKind::bad_file, std::string("is not a trial: ") + failure.what());
  }
}

std::string trials_csv(const std::vector<Trial>& trials, Times times) {
  const bool has_times = times == Times::shown;
  std::string csv =
      "seed,stop_reason,views,coverage,coverage_visible,attainable_coverage,distance_m,points,"
      "flown_m,"
      "flown_s";
  csv += has_times ? ",planning_time_s\n" : "\n";
  for (const Trial& trial : trials) {
    csv += std::to_string(trial.seed) + "," + session::name_of(trial.stop_reason) + "," +
           std::to_string(trial.views) + "," + support::exact_text(trial.coverage.all) + "," +
           csv_of(trial.coverage.visible) + "," + csv_of(trial.coverage.ceiling) + "," +
           support::exact_text(trial.distance) + "," + std::to_string(trial.points) + "," +
           csv_of(trial.flown_length) + "," + csv_of(trial.flown_time());
    csv += has_times ? "," + support::exact_text(trial.planning_time) + "\n" : "\n";
  }
  return csv;
}

std::string trials_json(const config::MissionSetup& mission, const std::vector<Trial>& trials,
                        std::size_t requested, unsigned threads) {
  Json json{{"mission", mission.name},
            {"planner", survey::title_of(mission.survey().planner.name).word},
            {"title", survey::title_of(mission.survey().planner.name).title},
            {"preset", mission.text("planner.preset")},
            {"first_seed", mission.run.seed},
            {"threads", geometry::thread_count(threads)},
            {"version", version},
            {"complete", trials.size() == requested},
            {"trials_requested", requested},
            {"trials", trials.size()},
            {"trials_complete", completed(trials)},
            {"attainable_coverage", trials.empty() ? Json() : json_of(trials[0].coverage.ceiling)}};
  if (trials.empty()) return support::json_text(json);
  for (const Figure& figure : figures) {
    json[figure.name] = statistic_json(statistic_of(trials, figure));
    if (const auto reference = reference_of(mission, figure)) {
      json[figure.name]["paper"] = *reference;
    }
  }
  if (std::ranges::all_of(trials, &Trial::is_flown)) {
    json["flown_s"] = statistic_json(
        statistic_of(trials, {"", [](const Trial& t) { return *t.flown_time(); }, {}, {}}));
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
  for (const Figure& figure : figures) {
    const Statistic statistic = statistic_of(trials, figure);
    const auto reference = reference_of(mission, figure);
    table += fmt::format("{:<18} {:12.4g} {:10.2g} {:10.2g} {:>12}\n", figure.name, statistic.mean,
                         statistic.half_width_95, statistic.deviation,
                         reference ? fmt::format("{:.4g}", *reference) : "-");
  }
  return table;
}

}  // namespace skycap::missions::batch
