#include "missions/report/comparison_page.h"

#include <set>
#include <vector>

#include <nlohmann/json.hpp>

#include "missions/report/page.h"
#include "missions/report/verdict.h"
#include "missions/support/number_text.h"

namespace skycap::missions::report {

using Json = nlohmann::ordered_json;

std::string benchmark_page(const ResultFinder& results) {
  const std::filesystem::path file = results("results.json");
  const Json summary = read_results(file);
  try {
    std::set<std::string> missions, planners;
    std::size_t trials = 0;
    for (const Json& cell : summary.at("results")) {
      missions.insert(cell.at("mission").get<std::string>());
      planners.insert(cell.at("planner").get<std::string>());
      trials += cell.at("trials").get<std::size_t>();
    }
    const Json data = {
        {"kind", "comparison"},
        {"title", "Comparison of planners"},
        {"facts",
         {support::counted(missions.size(), "mission"),
          support::counted(planners.size(), "planner"), support::counted(trials, "survey")}},
        {"summary", summary},
        {"files", files_json({"results.json", "table1.csv", "trials.csv", "report.md"}, results)}};
    return page_text(data.at("title"), data, {});
  } catch (const Json::exception& error) {
    reject_results(file, error.what());
  }
}

std::string trials_page(const ResultFinder& results) {
  const std::filesystem::path file = results("trials.json");
  const Json summary = read_results(file);
  try {
    const auto done = summary.at("trials").get<std::size_t>();
    const auto asked = summary.at("trials_requested").get<std::size_t>();
    const bool is_whole = summary.at("complete").get<bool>();
    const Json data = {
        {"kind", "trials"},
        {"title", summary.at("mission")},
        {"facts",
         {"planner " + summary.at("planner").get<std::string>(),
          "first seed " + std::to_string(summary.at("first_seed").get<std::uint64_t>())}},
        {"verdict", to_json(Verdict{
                        .is_complete = is_whole,
                        .because = std::to_string(done) + " of " + support::counted(asked, "trial"),
                        .lights = {}})},
        {"summary", summary},
        {"stop_words", stop_words()},
        {"files", files_json({"trials.json", "trials.csv"}, results)}};
    return page_text(summary.at("mission").get<std::string>(), data, {});
  } catch (const Json::exception& error) {
    reject_results(file, error.what());
  }
}

}  // namespace skycap::missions::report
