#include "missions/report/results.h"

#include <system_error>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "missions/package/former_fields.h"
#include "missions/support/sha256.h"

namespace skycap::missions::report {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

ResultFinder results_in(const fs::path& folder) {
  return [folder](const std::string& name) { return folder / name; };
}

bool is_there(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored);
}

std::string results_text(const fs::path& file) {
  return geometry::read_file(file, geometry::largest_json);
}

Json read_results(const fs::path& file) {
  Json json = geometry::parse_json<Json>(results_text(file));
  package::use_current_fields(json);
  if (json.is_object()) return json;
  throw Error(ErrorKind::bad_file, file.string() +
                                       ": is not a JSON object or is nested too deeply; specify a "
                                       "results folder written by skycap");
}

void reject_results(const fs::path& file, std::string_view reason) {
  throw Error(ErrorKind::bad_file, file.string() + ": is damaged (" + std::string(reason) + ")");
}

Json files_json(const std::vector<std::string>& names, const ResultFinder& results,
                bool has_checksums) {
  Json files = Json::array();
  for (const std::string& name : names) {
    if (fs::path(name).filename() != name || !is_there(results(name))) continue;
    files.push_back({{"name", name}, {"bytes", fs::file_size(results(name))}});
    if (has_checksums) files.back()["sha256"] = support::compute_file_sha256(results(name));
  }
  return files;
}

}  // namespace skycap::missions::report
