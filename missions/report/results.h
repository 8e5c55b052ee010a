/// Access to the result files of a report.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace skycap::missions::report {

/// Returns the path of a result file, either committed or staged. Missing files have a path that
/// does not exist.
using ResultFinder = std::function<std::filesystem::path(const std::string& name)>;

/// Returns the finder for a folder of committed results.
ResultFinder results_in(const std::filesystem::path& folder);

inline constexpr std::size_t default_report_points = 1'000'000;

bool is_there(const std::filesystem::path& file);

/// Returns the contents of a JSON results file of up to geometry::largest_json bytes.
std::string results_text(const std::filesystem::path& file);

/// Reads a JSON object from a results file. Throws Error{bad_file} with the file name if the
/// contents are invalid.
nlohmann::ordered_json read_results(const std::filesystem::path& file);

/// Throws Error{bad_file} for missing or invalid values in the file.
[[noreturn]] void reject_results(const std::filesystem::path& file, std::string_view reason);

/// Returns {"name", "bytes", "sha256"} of existing files, so that users can verify that a file
/// belongs to the report. Hashes of large files take seconds and are omitted after Ctrl-C
/// (`has_checksums`). Names in other folders are ignored.
nlohmann::ordered_json files_json(const std::vector<std::string>& names,
                                  const ResultFinder& results, bool has_checksums = true);

}  // namespace skycap::missions::report
