#include "missions/batch/benchmark/other_results.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"

namespace skycap::missions::batch {
namespace {

using Json = nlohmann::ordered_json;

/// Trial in a file, with its description for messages.
class TrialReader {
 public:
  TrialReader(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
    if (!json.is_object()) fail("must be an object");
  }

  Trial read(std::uint64_t number) {
    Trial trial;
    trial.seed = number;
    if (json_.contains("seed")) trial.seed = seed();
    trial.coverage_after = list("coverage_after", 0.0, 1.0, false);
    trial.distance_after = list("distance_after_m", 0.0, 1e9, true);
    trial.views = trial.coverage_after.size();
    if (trial.views == 0) fail("coverage_after must have a number for each view");
    require_length("distance_after_m", trial.distance_after, trial.views);
    trial.planning_time_after.assign(trial.views, 0.0);
    if (json_.contains("planning_time_after_s")) {
      trial.planning_time_after = list("planning_time_after_s", 0.0, 1e9, true);
      require_length("planning_time_after_s", trial.planning_time_after, trial.views);
    }
    trial.coverage.all = trial.coverage_after.back();
    trial.distance = trial.distance_after.back();
    trial.planning_time = trial.planning_time_after.back();
    if (json_.contains("coverage_visible")) {
      trial.coverage.visible = read_number(json_["coverage_visible"], "coverage_visible", 0.0, 1.0);
    }
    if (json_.contains("points")) {
      trial.points = static_cast<std::size_t>(read_number(json_["points"], "points", 0.0, 1e15));
    }
    if (json_.contains("stop_reason")) trial.stop_reason = stop_reason();
    return trial;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::bad_file, where_ + ": " + what);
  }

  double read_number(const Json& json, const std::string& field, double min, double max) const {
    const double number = json.is_number() ? json.get<double>() : std::nan("");
    if (!(number >= min && number <= max)) {
      fail(fmt::format("{} must be a number from {:g} to {:g}", field, min, max));
    }
    return number;
  }

  std::vector<double> list(const std::string& field, double min, double max, bool rises) const {
    if (!json_.contains(field) || !json_[field].is_array()) {
      fail("missing " + field + "; expected a list with a number for each view");
    }
    std::vector<double> numbers;
    for (const Json& item : json_[field]) numbers.push_back(read_number(item, field, min, max));
    if (rises && !std::ranges::is_sorted(numbers)) fail(field + " must not decrease");
    return numbers;
  }

  void require_length(const std::string& field, const std::vector<double>& numbers,
                      std::size_t views) const {
    if (numbers.size() == views) return;
    fail(fmt::format("{} has {} numbers; expected {}, as in coverage_after", field, numbers.size(),
                     views));
  }

  std::uint64_t seed() const {
    if (!json_["seed"].is_number_unsigned()) fail("seed must be an integer of zero or more");
    return json_["seed"].get<std::uint64_t>();
  }

  survey::StopReason stop_reason() const {
    const Json& json = json_["stop_reason"];
    try {
      return session::stop_reason_named(json.is_string() ? json.get<std::string>() : "");
    } catch (const Error& error) {
      fail(std::string("stop_reason: ") + error.what());
    }
  }

  const Json& json_;
  std::string where_;
};

std::string name_in(const Json& json, const char* field, const std::string& where) {
  if (!json.is_object() || !json.contains(field) || !json[field].is_string()) {
    throw Error(ErrorKind::bad_file, where + ": missing " + field + "; expected a name");
  }
  std::string name = json[field];
  const auto is_bad = [](unsigned char c) { return c < ' ' || c == ',' || c == '|'; };
  constexpr std::size_t longest = 60;
  if (name.empty() || name.size() > longest || std::ranges::any_of(name, is_bad)) {
    throw Error(ErrorKind::bad_file,
                where + ": " + field +
                    " must have 1 to 60 characters without control characters, "
                    "commas and vertical bars");
  }
  return name;
}

BenchmarkCell cell_in(const Json& json, const std::string& where) {
  BenchmarkCell cell{name_in(json, "mission", where), name_in(json, "planner", where), {}};
  if (!json.contains("trials") || !json["trials"].is_array() || json["trials"].empty()) {
    throw Error(ErrorKind::bad_file,
                where + ": missing trials; expected a list with at least one trial");
  }
  for (const Json& trial : json["trials"]) {
    const std::size_t number = cell.trials.size() + 1;
    cell.trials.push_back(
        TrialReader(trial, fmt::format("{}: trial {}", where, number)).read(number));
  }
  return cell;
}

}  // namespace

std::vector<BenchmarkCell> read_other_results(const std::filesystem::path& file) {
  Json json = geometry::parse_json<Json>(geometry::read_file(file, geometry::largest_json));
  if (json.is_discarded()) {
    throw Error(ErrorKind::bad_file, file.string() + ": is not valid JSON; correct it");
  }
  std::vector<BenchmarkCell> cells;
  if (!json.is_array()) json = Json::array({json});
  for (const Json& item : json) cells.push_back(cell_in(item, file.string()));
  return cells;
}

}  // namespace skycap::missions::batch
