#include "missions/report/result_pages.h"

#include <algorithm>

#include "geometry/error.h"
#include "missions/package/package.h"
#include "missions/report/comparison_page.h"
#include "missions/report/scan_page.h"
#include "missions/report/survey_report.h"

namespace skycap::missions::report {

const std::vector<ResultPage>& result_pages() {
  static const std::vector<ResultPage> pages = {
      {package::summary_name, package::report_name, survey_report},
      {"trials.json", "trials.html",
       [](const ResultFinder& results, std::size_t) { return trials_page(results); }},
      {"results.json", "benchmark.html",
       [](const ResultFinder& results, std::size_t) { return benchmark_page(results); }},
      {"scan.json", "scan.html", scan_page}};
  return pages;
}

std::vector<ResultPage> pages_of(const std::filesystem::path& folder) {
  std::vector<ResultPage> found;
  std::string names;
  for (const ResultPage& page : result_pages()) {
    if (is_there(folder / page.results)) found.push_back(page);
    names += (names.empty() ? "" : ", ") + page.results;
  }
  if (!found.empty()) return found;
  throw Error(ErrorKind::bad_file, folder.string() +
                                       ": has no results to show; name a folder that plan, scan, "
                                       "benchmark or finish wrote, with one of " +
                                       names);
}

std::optional<std::string> stage_page(const std::string& results, bool is_wanted,
                                      geometry::OutputFolder& folder) {
  const auto page = std::ranges::find(result_pages(), results, &ResultPage::results);
  folder.replace([&](std::string_view name) { return name == page->name; });
  if (!is_wanted) return std::nullopt;
  std::string text;
  try {
    text = page->make([&](const std::string& name) { return folder.staged(name); },
                      default_report_points);
  } catch (const Error& error) {
    return error.what();
  }
  folder.write(page->name, text);
  return std::nullopt;
}

}  // namespace skycap::missions::report
