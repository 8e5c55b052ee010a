/// report.html of a survey, made of what its folder holds and of nothing else.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace skycap::missions::report {

/// Where the results of a folder are: under their own names, or still staged. A path that does not
/// exist stands for a file that is not there.
using ResultFinder = std::function<std::filesystem::path(const std::string& name)>;

/// The finder of a folder as it is on disk.
ResultFinder results_in(const std::filesystem::path& folder);

inline constexpr std::size_t default_report_points = 1'000'000;

/// The page of the survey that summary.json tells of, with at most so many points of cloud.ply.
/// Without cloud.ply or coverage.ply it goes without them. Throws Error{bad_file} naming the file
/// if one is not as `skycap plan` writes it.
std::string survey_report(const ResultFinder& results,
                          std::size_t most_points = default_report_points);

}  // namespace skycap::missions::report
