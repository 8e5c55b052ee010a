/// Which pages a folder of results has, by what lies in it.
#pragma once

#include <filesystem>
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

/// A survey, its trials, a comparison, a scan, a district.
const std::vector<ResultPage>& result_pages();

/// A page and where it belongs.
struct MadePage {
  std::filesystem::path file;
  std::optional<std::string> text;  ///< nothing: it is there as it should be
};

/// The pages of what a folder holds, of at most so many points, in the folder or at `out`. A live
/// survey that goes on has the page that its verbs keep. Throws Error{bad_file} if there is nothing
/// to show, Error{bad_usage} if several pages should be at `out`.
std::vector<MadePage> made_pages(const std::filesystem::path& folder, std::size_t most_points,
                                 const std::optional<std::filesystem::path>& out);

/// Stages the page of staged results beside them, if it is wanted; an older one is void in any
/// case. What cannot be shown, such as a cloud too far from the origin for its file, shall not cost
/// the results: then there is no page, and what is returned says why.
std::optional<std::string> stage_page(const std::string& results, bool is_wanted,
                                      geometry::OutputFolder& folder);

}  // namespace skycap::missions::report
