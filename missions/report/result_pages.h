/// Selects the HTML reports for a results folder by its files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/report/results.h"

namespace skycap::missions::report {

/// HTML report and its input.
struct ResultPage {
  std::string results;  ///< main results file, such as summary.json
  std::string name;     ///< file name of the report, such as report.html
  std::string (*make)(const ResultFinder& results, std::size_t max_points);
};

/// Returns the reports of surveys, trials, planner comparisons, scans, flown logs and districts.
const std::vector<ResultPage>& result_pages();

/// Generated report with its path.
struct MadePage {
  std::filesystem::path file;
  std::optional<std::string> text;  ///< contents; nullopt if the existing file is current
};

/// Generates the reports of a folder with up to `max_points` points, to be written in the folder
/// or at `out`. The report of a running live survey is not regenerated, because its commands keep
/// it current. Throws Error{bad_file} if the folder has no results, and Error{bad_usage} if several
/// reports share `out`.
std::vector<MadePage> made_pages(const std::filesystem::path& folder, std::size_t max_points,
                                 const std::optional<std::filesystem::path>& out);

/// Stages the report of staged results if `is_selected`; otherwise an existing report is removed.
/// Errors, such as a cloud too far from the origin, do not affect the results. The report is then
/// omitted, and the reason is returned.
std::optional<std::string> stage_page(const std::string& results, bool is_selected,
                                      geometry::OutputFolder& folder);

}  // namespace skycap::missions::report
