/// Which pages a folder of results has, by what lies in it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/report/results.h"

namespace skycap::missions::report {

/// A page and what it is of.
struct ResultPage {
  std::string results;  ///< the file that says what the others are, such as summary.json
  std::string name;     ///< of the page, such as report.html
  std::string (*make)(const ResultFinder& results, std::size_t most_points);
};

/// A survey, its trials, a comparison, a scan.
const std::vector<ResultPage>& result_pages();

/// Those whose results are there. Throws Error{bad_file} if there are none.
std::vector<ResultPage> pages_of(const std::filesystem::path& folder);

/// Stages the page of staged results beside them, if it is wanted; an older one is void in any
/// case. What cannot be shown, such as a cloud too far from the origin for its file, shall not cost
/// the results: then there is no page, and what is returned says why.
std::optional<std::string> stage_page(const std::string& results, bool is_wanted,
                                      geometry::OutputFolder& folder);

}  // namespace skycap::missions::report
