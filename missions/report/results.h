/// Where a page's results are.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace skycap::missions::report {

/// Where the results of a folder are: under their own names, or still staged. A path that does not
/// exist stands for a file that is not there.
using ResultFinder = std::function<std::filesystem::path(const std::string& name)>;

/// The finder of a folder as it is on disk.
ResultFinder results_in(const std::filesystem::path& folder);

inline constexpr std::size_t default_report_points = 1'000'000;

bool is_there(const std::filesystem::path& file);

/// The text of a JSON file of results, of at most geometry::largest_json.
std::string results_text(const std::filesystem::path& file);

/// The object in a JSON file of results. Throws Error{bad_file} naming the file if it holds none.
nlohmann::ordered_json read_results(const std::filesystem::path& file);

/// Throws Error{bad_file}: values of the file are missing or of another kind.
[[noreturn]] void refuse_results(const std::filesystem::path& file, std::string_view why);

/// {"name", "bytes", "sha256"} of those that are there, so that whoever has a file can see that it
/// is the one of the page; digests of large files take seconds, which who has pressed Ctrl-C does
/// not wait for. Names that lead to other folders are passed over.
nlohmann::ordered_json files_json(const std::vector<std::string>& names,
                                  const ResultFinder& results, bool has_digests = true);

}  // namespace skycap::missions::report
