#include "missions/report/district_page.h"

#include <cstddef>

#include <nlohmann/json.hpp>

#include "missions/report/page.h"
#include "missions/report/verdict.h"
#include "missions/support/number_text.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;

Verdict district_verdict(const Json& summary) {
  const Json& targets = summary.at("targets");
  const auto surveyed = summary.at("surveyed").get<std::size_t>();
  Verdict verdict{.is_complete = summary.at("complete").get<bool>(),
                  .because = std::to_string(surveyed) + " of " +
                             support::counted(targets.size(), "target") + " surveyed",
                  .lights = {}};
  if (const Json& flight = summary.at("flight"); flight.is_object()) {
    const auto views = flight.at("views").get<std::size_t>();
    const auto visited = flight.at("views_flown").get<std::size_t>();
    verdict.lights = {
        {"views in the flight, out of " + std::to_string(views), "flight.views_flown", "count",
         visited, visited == views ? "green" : "amber", "green: all views"},
        {"minimum clearance (verified)", "flight.min_clearance_m", "metres",
         flight.at("min_clearance_m"), "green", "green: every leg keeps the required clearance"},
        {"sorties", "flight.sorties", "count", flight.at("sorties"), "none", ""},
        {"flight", "flight.duration_s", "minutes", flight.at("duration_s"), "none", ""}};
  }
  return verdict;
}

}  // namespace

std::string district_page(const ResultFinder& results) {
  const std::filesystem::path file = results("district.json");
  const Json summary = read_results(file);
  try {
    const auto title = summary.at("district").get<std::string>();
    const Json data = {
        {"kind", "district"},
        {"title", title},
        {"facts",
         {summary.at("map"), support::counted(summary.at("targets").size(), "target"),
          "vehicle " + summary.at("vehicle").get<std::string>(),
          "planner " + summary.at("planner").get<std::string>()}},
        {"verdict", to_json(district_verdict(summary))},
        {"summary", summary},
        {"stop_words", stop_words()},
        {"files", files_json({"district.json", "targets.csv", "times.csv"}, results)}};
    return page_text(title, data, {});
  } catch (const Json::exception& error) {
    reject_results(file, error.what());
  }
}

}  // namespace skycap::missions::report
