/// What a scan leaves while it runs, so that one that was interrupted, by Ctrl-C, a kill or a power
/// cut, goes on where it was, with the same files as if nothing had happened.
///
/// The files grow in a folder of their own beside the results, where nothing is committed yet. Now
/// and then they are brought to the disk, and a record of the journal says how far they and the
/// flight had come. What was appended after the last record is cut off and measured again.
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
  /// Of the folder, among the results.
  static constexpr const char* folder_name = "unfinished";

  /// Of a scan whose results are in that folder; nothing is read or written yet.
  explicit ScanJournal(const std::filesystem::path& results);

  const std::filesystem::path& file() const { return file_; }

  /// Begins a scan, in place of what was there; or goes on with the one that was interrupted
  /// there, if there is one (`resumes`), and returns what its last checkpoint() said. Null without
  /// one. `more` is what beside the identity decides the files. Throws Error{bad_file} naming
  /// the journal if it is of another scan, saying what is different, or damaged.
  nlohmann::ordered_json open(const support::Identity& run, const nlohmann::ordered_json& more,
                              bool resumes);

  /// Whether a scan of just this was interrupted there, so that open() may go on with it.
  bool is_of(const support::Identity& run, const nlohmann::ordered_json& more) const;

  /// Where a file of the scan is.
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }

  /// The same of a file that is about to change: results that share its bytes keep theirs.
  std::filesystem::path path_to_change(const std::string& name) const;

  /// Writes down how far the scan has come. The files that the state speaks of must be on the disk;
  /// their names are brought there.
  void checkpoint(const nlohmann::ordered_json& state);

  /// Stages a file of the scan for the results. It stays here, too: both share its bytes.
  void stage(const std::string& name, geometry::OutputFolder& results) const;
  /// The same of a file whose bytes are on the disk.
  void stage_on_disk(const std::string& name, geometry::OutputFolder& results) const;

  /// Removes all of it: the scan has ended and its results are committed.
  void close();

 private:
  void begin(const std::string& identity);

  std::filesystem::path folder_, file_;
  std::optional<geometry::RecordLog> log_;
};

}  // namespace skycap::missions::scan
