#include "missions/batch/benchmark/trials.h"

#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <boost/math/distributions/students_t.hpp>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "missions/batch/benchmark/protocol_g.h"
#include "missions/evaluation/coverage.h"
#include "missions/package/former_fields.h"
#include "missions/scene/scene_source.h"
#include "missions/support/json_text.h"
#include "missions/support/sha256.h"
#include "missions/version.h"

namespace skycap::missions::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::vector<ObservedTarget> observed_targets(const std::vector<session::EvaluatedView>& views) {
  std::vector<ObservedTarget> observed;
  ObservedTarget current;
  double distance_before = 0.0;
  for (const session::EvaluatedView& view : views) {
    const double flown = view.surveyed.distance - distance_before;
    distance_before = view.surveyed.distance;
    const std::optional<bool>& is_resolved = view.surveyed.step.target_resolved;
    if (!is_resolved) continue;  // the first view has no target
    ++current.views;
    current.distance += flown;
    if (!*is_resolved) continue;
    observed.push_back(current);
    current = {};
  }
  return observed;
}

std::optional<double> optional_number(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

Json optional_json(const std::optional<double>& number) { return number ? Json(*number) : Json(); }

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
    truth.attainable_coverage = evaluation::marked_share(*marks);
  }
  return truth;
}

Trial make_trial(const session::SurveyRecord& record, const evaluation::SurveyScene& scene,
                 const SceneTruth& truth) {
  Trial trial;
  trial.seed = record.seed;
  trial.stop_reason = record.stop_reason;
  trial.coverage = {record.coverage(),
                    evaluation::covered_share(record.is_covered, truth.is_visible),
                    truth.attainable_coverage};
  trial.views = record.views.size();
  trial.points = record.cloud.size();
  trial.distance = record.distance();
  for (const session::EvaluatedView& view : record.views) {
    trial.planning_time += view.surveyed.planning_processor_time;
    trial.coverage_after.push_back(view.coverage);
    trial.distance_after.push_back(view.surveyed.distance);
    trial.planning_time_after.push_back(trial.planning_time);
    trial.frontiers_resolved += view.surveyed.step.frontiers_resolved;
  }
  const std::vector<Eigen::Vector3f>& samples = scene.samples().points;
  const GridCoverage grid =
      compute_grid_coverage(record.cloud.positions, samples, truth.is_visible);
  trial.grid_coverage = grid.all;
  trial.grid_coverage_visible = grid.visible;
  trial.chamfer_distance = compute_chamfer_distance(record.cloud.positions, samples);
  trial.targets = observed_targets(record.views);
  if (record.flight_record) {
    trial.flight_length = record.flight_record->length();
    trial.flight_time_after = record.flight_record->times;
  }
  return trial;
}

std::string trial_json(const Trial& trial) {
  Json json{{"seed", trial.seed},
            {"stop_reason", session::to_string(trial.stop_reason)},
            {"coverage", trial.coverage.all},
            {"coverage_visible", optional_json(trial.coverage.visible)},
            {"attainable_coverage", optional_json(trial.coverage.attainable_coverage)},
            {"views", trial.views},
            {"points", trial.points},
            {"planning_time_s", trial.planning_time},
            {"distance_m", trial.distance},
            {"flown_m", optional_json(trial.flight_length)},
            {"flown_s", optional_json(trial.flight_time())},
            {"grid_coverage", optional_json(trial.grid_coverage)},
            {"grid_coverage_visible", optional_json(trial.grid_coverage_visible)},
            {"chamfer_distance_m", optional_json(trial.chamfer_distance)},
            {"frontiers_resolved", trial.frontiers_resolved},
            {"coverage_after", trial.coverage_after},
            {"distance_after_m", trial.distance_after},
            {"planning_time_after_s", trial.planning_time_after},
            {"flown_after_s", trial.flight_time_after},
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
    trial.flight_length = optional_number(json.at("flown_m"));
    // Trials of earlier versions do not contain these fields.
    trial.grid_coverage = optional_number(json.value("grid_coverage", Json()));
    trial.grid_coverage_visible = optional_number(json.value("grid_coverage_visible", Json()));
    trial.chamfer_distance = optional_number(json.value("chamfer_distance_m", Json()));
    trial.frontiers_resolved = json.at("frontiers_resolved").get<std::size_t>();
    trial.coverage_after = json.at("coverage_after").get<std::vector<double>>();
    trial.distance_after = json.at("distance_after_m").get<std::vector<double>>();
    trial.planning_time_after = json.at("planning_time_after_s").get<std::vector<double>>();
    trial.flight_time_after = json.at("flown_after_s").get<std::vector<double>>();
    for (const Json& target : json.at("targets")) {
      trial.targets.push_back({target.at(0).get<std::size_t>(), target.at(1).get<double>()});
    }
    return trial;
  } catch (const nlohmann::json::exception& failure) {
    throw Error(ErrorKind::bad_file, std::string("is not a trial: ") + failure.what());
  }
}

std::string trial_fingerprint(const config::MissionSetup& mission, const std::string& method,
                              const fs::path& folder) {
  std::string inputs = std::string(version) + "\n" + method;
  for (const auto& [key, value] : mission.settings) {
    inputs.append("\n").append(key).append(" ").append(value);
  }
  for (const fs::path& file : scene::collect_files(mission.scene(), mission.lidar, folder)) {
    std::error_code ignored;  // missing files are reported when the scene is loaded
    const bool is_there = fs::is_regular_file(file, ignored);
    inputs.append("\n").append(is_there ? support::compute_file_sha256(file) : "-");
  }
  const auto* own = std::get_if<survey::external::ExternalConfig>(&mission.survey().planner.method);
  if (own != nullptr) {
    std::error_code ignored;  // a missing file is reported when the planner is created
    const bool is_there = fs::is_regular_file(own->file, ignored);
    inputs.append("\n").append(is_there ? support::compute_file_sha256(own->file) : "-");
  }
  return support::sha256(std::as_bytes(std::span(inputs)));
}

TrialRun run_here(double wall_time) {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  constexpr std::size_t unit = 1024;  // unit of ru_maxrss on Linux [byte]
  return {host.data(), wall_time, unit * static_cast<std::size_t>(usage.ru_maxrss)};
}

std::optional<TrialRecord> finished_trial(const fs::path& file, const std::string& fingerprint) {
  if (!fs::exists(file)) return std::nullopt;
  try {
    const Json json = geometry::parse_json<Json>(geometry::read_file(file, geometry::largest_json));
    if (json.at("fingerprint") != fingerprint) return std::nullopt;
    const Json& run = json.at("run");
    return TrialRecord{parse_trial(json.at("trial").dump()),
                       {run.at("host").get<std::string>(), run.at("wall_time_s").get<double>(),
                        run.at("peak_memory_bytes").get<std::size_t>()}};
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // the file has another format and is overwritten
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::string trial_record_json(const std::string& fingerprint, const TrialRecord& record) {
  return support::json_text({{"fingerprint", fingerprint},
                             {"run",
                              {{"host", record.run.host},
                               {"wall_time_s", record.run.wall_time},
                               {"peak_memory_bytes", record.run.peak_memory}}},
                             {"trial", Json::parse(trial_json(record.trial))}});
}

}  // namespace skycap::missions::batch
