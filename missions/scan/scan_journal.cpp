#include "missions/scan/scan_journal.h"

#include <system_error>
#include <vector>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "missions/support/journal_text.h"

namespace skycap::missions::scan {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void require_success(const std::error_code& failure, const fs::path& path, const char* what) {
  if (!failure) return;
  throw Error(ErrorKind::bad_file, path.string() + ": " + what + " (" + failure.message() + ")");
}

/// Copies a file.
void copy_bytes(const fs::path& from, const fs::path& to) {
  std::error_code failure;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, failure);
  require_success(failure, to, "cannot be written");
}

/// Creates a hard link or, where links are not supported, a copy. Returns true for a link.
bool link_or_copy(const fs::path& from, const fs::path& to) {
  // Set on file systems without hard links, such as those of memory cards.
  std::error_code no_links;
  fs::create_hard_link(from, to, no_links);
  if (no_links) copy_bytes(from, to);
  return !no_links;
}

}  // namespace

ScanJournal::ScanJournal(const fs::path& results)
    : folder_(results / folder_name), file_(folder_ / "scan.journal") {}

Json ScanJournal::open(const support::Identity& run, const Json& more, bool resumes) {
  const std::string identity = support::identity_text(run, more);
  if (resumes && fs::exists(file_)) log_.emplace(file_);
  if (!log_ || log_->records().empty()) {
    begin(identity);
    return nullptr;
  }
  const std::vector<std::string>& records = log_->records();
  support::require_same_survey(file_.string(), records.front(), identity,
                               "start again without --resume");
  return records.size() > 1 ? geometry::parse_json<Json>(records.back()) : Json();
}

bool ScanJournal::matches_run(const support::Identity& run, const Json& more) const {
  try {
    const std::vector<std::string> records = geometry::read_records(file_).records;
    return !records.empty() && records.front() == support::identity_text(run, more);
  } catch (const Error&) {
    return false;  // A damaged journal does not match any scan.
  }
}

void ScanJournal::begin(const std::string& identity) {
  close();
  std::error_code failure;
  fs::create_directories(folder_, failure);
  require_success(failure, folder_, "cannot be created");
  geometry::sync_to_disk(folder_.parent_path());
  log_.emplace(file_);
  log_->append(identity);
}

fs::path ScanJournal::path_to_change(const std::string& name) const {
  fs::path path = folder_ / name;
  std::error_code missing;
  if (fs::hard_link_count(path, missing) > 1 && !missing) {
    const fs::path own = folder_ / ("own-" + name);
    copy_bytes(path, own);
    std::error_code failure;
    fs::rename(own, path, failure);
    require_success(failure, path, "cannot be replaced");
  }
  return path;
}

void ScanJournal::checkpoint(const Json& state) {
  geometry::sync_to_disk(folder_);  // Flushes the directory entries of new files.
  log_->append(support::journal_line(state));
}

void ScanJournal::stage(const std::string& name, geometry::OutputFolder& results) const {
  link_or_copy(folder_ / name, results.stage(name));
}

void ScanJournal::stage_on_disk(const std::string& name, geometry::OutputFolder& results) const {
  const fs::path staged = results.stage_on_disk(name);
  if (!link_or_copy(folder_ / name, staged)) geometry::sync_to_disk(staged);
}

void ScanJournal::close() {
  log_.reset();
  std::error_code failure;
  fs::remove_all(folder_, failure);
  require_success(failure, folder_, "cannot be removed");
}

}  // namespace skycap::missions::scan
