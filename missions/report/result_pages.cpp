#include "missions/report/result_pages.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/package/package.h"
#include "missions/report/comparison_page.h"
#include "missions/report/district_page.h"
#include "missions/report/flown_page.h"
#include "missions/report/inspection_page.h"
#include "missions/report/photo_page.h"
#include "missions/report/scan_page.h"
#include "missions/report/survey_report.h"

namespace skycap::missions::report {

namespace {

namespace fs = std::filesystem;

/// Returns the reports whose results are in the folder.
std::vector<ResultPage> pages_in(const fs::path& folder) {
  std::vector<ResultPage> found;
  for (const ResultPage& page : result_pages()) {
    if (is_there(folder / page.results)) found.push_back(page);
  }
  return found;
}

[[noreturn]] void reject_folder(const fs::path& folder) {
  std::string names;
  for (const ResultPage& page : result_pages()) {
    names += (names.empty() ? "" : ", ") + page.results;
  }
  throw Error(ErrorKind::bad_file, folder.string() +
                                       ": contains no results; specify a folder written by plan, "
                                       "scan, compare, benchmark or finish that contains one of " +
                                       names);
}

/// Returns the report of summary.json: of a survey, a photo mission or an inspection.
std::string summary_page(const ResultFinder& results, std::size_t max_points) {
  const nlohmann::ordered_json summary = read_results(results(package::summary_name));
  const std::string kind = summary.is_object() ? summary.value("kind", std::string()) : "";
  if (kind == "photos") return photo_page(results, max_points);
  if (kind == "inspection") return inspection_page(results, max_points);
  return survey_report(results, max_points);
}

/// Replaces names of staged files in a message by their final names.
std::string by_final_names(std::string message, const std::vector<std::string>& names,
                           const geometry::OutputFolder& folder) {
  for (const std::string& name : names) {
    const std::string temporary = folder.staged(name).string();
    if (temporary.empty()) continue;
    const std::size_t at = message.find(temporary);
    if (at != std::string::npos) {
      message.replace(at, temporary.size(), (folder.path() / name).string());
    }
  }
  return message;
}

}  // namespace

const std::vector<ResultPage>& result_pages() {
  static const std::vector<ResultPage> pages = {
      {package::summary_name, package::report_name, summary_page},
      {"trials.json", "trials.html",
       [](const ResultFinder& results, std::size_t) { return trials_page(results); }},
      {"results.json", "benchmark.html",
       [](const ResultFinder& results, std::size_t) { return benchmark_page(results); }},
      {"scan.json", "scan.html", scan_page},
      {"compare.json", "compare.html", flown_page},
      {"district.json", "district.html",
       [](const ResultFinder& results, std::size_t) { return district_page(results); }}};
  return pages;
}

std::vector<MadePage> made_pages(const fs::path& folder, std::size_t max_points,
                                 const std::optional<fs::path>& out) {
  geometry::finish_commit(folder);
  const std::vector<ResultPage> found = pages_in(folder);
  const fs::path kept = folder / package::report_name;
  if (found.empty() && is_there(kept)) {
    if (!out) return {{kept, std::nullopt}};
    return {{*out, geometry::read_file(kept)}};
  }
  if (found.empty()) reject_folder(folder);
  if (out && found.size() > 1) {
    throw Error(ErrorKind::bad_usage, folder.string() +
                                          ": contains several reports; remove --out or move one of "
                                          "the results to a separate folder");
  }
  std::vector<MadePage> pages;
  pages.reserve(found.size());
  for (const ResultPage& page : found) {
    pages.push_back({out.value_or(folder / page.name), page.make(results_in(folder), max_points)});
  }
  return pages;
}

std::optional<std::string> stage_page(const std::string& results, bool is_selected,
                                      geometry::OutputFolder& folder) {
  const auto page = std::ranges::find(result_pages(), results, &ResultPage::results);
  folder.replace([&](std::string_view name) { return name == page->name; });
  if (!is_selected) return std::nullopt;
  std::vector<std::string> asked;
  const auto staged = [&](const std::string& name) {
    asked.push_back(name);
    return folder.staged(name);
  };
  std::string text;
  try {
    text = page->make(staged, default_report_points);
  } catch (const Error& error) {
    return by_final_names(error.what(), asked, folder);
  }
  folder.write(page->name, text);
  return std::nullopt;
}

}  // namespace skycap::missions::report
