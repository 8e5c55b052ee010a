/// Journal of a running scan. A scan interrupted by Ctrl-C, a kill or a power failure can be
/// resumed and gives identical files.
///
/// The files grow in a folder next to the results, before they are committed. At each checkpoint
/// they are flushed to disk, and a journal record stores their extents and the progress of the
/// flight. Data appended after the last record is discarded and measured again.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "geometry/io/output_folder.h"
#include "geometry/io/record_log.h"
#include "missions/support/identity.h"

namespace skycap::missions::scan {

class ScanJournal {
 public:
  /// Name of the journal's folder within the results.
  static constexpr const char* folder_name = "unfinished";

  /// Creates the journal of a scan with this results folder. Does not access files.
  explicit ScanJournal(const std::filesystem::path& results);

  const std::filesystem::path& file() const { return file_; }

  /// Starts a new scan and discards an existing one. With `resumes`, continues an interrupted scan
  /// if there is one and returns the state of its last checkpoint(); otherwise returns null. `more`
  /// contains all inputs that determine the files in addition to the identity. Throws
  /// Error{bad_file} naming the journal if it is damaged or belongs to another scan; the message
  /// lists the differences.
  nlohmann::ordered_json open(const support::Identity& run, const nlohmann::ordered_json& more,
                              bool resumes);

  /// Returns true if an interrupted scan with exactly these inputs exists, which open() can resume.
  bool matches_run(const support::Identity& run, const nlohmann::ordered_json& more) const;

  /// Returns the path of a file of the scan.
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }

  /// Returns the path of a file for modification. Results that share the file's data through a hard
  /// link are not affected.
  std::filesystem::path path_to_change(const std::string& name) const;

  /// Records the progress of the scan. The files that `state` refers to must be on disk; their
  /// directory entries are flushed here.
  void checkpoint(const nlohmann::ordered_json& state);

  /// Stages a file of the scan for the results. The journal's copy remains and shares its data.
  void stage(const std::string& name, geometry::OutputFolder& results) const;
  /// Stages a file whose data has been flushed to disk, like stage().
  void stage_on_disk(const std::string& name, geometry::OutputFolder& results) const;

  /// Removes the journal's folder after the results have been committed.
  void close();

 private:
  void begin(const std::string& identity);

  std::filesystem::path folder_, file_;
  std::optional<geometry::RecordLog> log_;
};

}  // namespace skycap::missions::scan
