/// Runs batches of surveys locally with a progress line, or as tasks of a scheduler. Used by `plan
/// --trials`, `benchmark`, `campaign` and `district`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/batch/campaign/survey_batch.h"
#include "missions/cli/command_options.h"
#include "missions/cli/console.h"

namespace skycap::missions::cli {

/// Runs surveys and shows the number of completed surveys and the remaining time. The estimate uses
/// the mean duration of completed surveys of the same kind (mission and planner). Until one has
/// completed, it uses the mean of all kinds.
class SurveyRunner {
 public:
  /// `command` is the prefix of the progress line. Up to `threads` surveys run concurrently; zero
  /// selects the number of processors. `has_report` adds HTML reports to the packages.
  SurveyRunner(std::string command, const Console& console, bool is_quiet, unsigned threads,
               bool has_report = false);

  /// Runs the items with batch::run_items(). `failed`, if set, is called for each failure.
  batch::Records run(const std::vector<batch::BatchItem>& items,
                     const std::function<void(const Error&)>& failed = {});

  /// Adds expected surveys of a kind to the progress total. run() adds surveys that were not
  /// announced.
  void announce(const std::string& kind, std::size_t surveys);

  void show_status(const std::string& text);
  void clear();

 private:
  struct Kind {
    std::size_t announced = 0, left = 0, done = 0;
    double seconds = 0.0;
  };

  void survey_done(const std::string& kind, double seconds);
  double work_left() const;

  std::string command_;
  const Console& console_;
  unsigned threads_;
  bool has_report_;
  ProgressLine line_;
  std::mutex mutex_;
  std::size_t total_ = 0;
  Kind all_kinds_;
  std::map<std::string, Kind> kinds_;
};

struct BatchOptions {
  std::filesystem::path file;                ///< campaign or district file
  std::optional<std::filesystem::path> out;  ///< output folder; default: results/NAME
  TaskOptions task;
  std::optional<unsigned> threads;  ///< default: all processors, or one for a single task
  bool lists = false;
  bool has_report = true;
  bool is_quiet = false;

  std::filesystem::path folder(const std::string& name) const;
};

/// Adds the options of BatchOptions. `what` is the placeholder for the file in the help.
void add_batch_options(CLI::App& command, BatchOptions& options, const std::string& what);

/// Result of one item, if it exists.
struct CollectedItem {
  std::size_t number;  ///< index in the manifest
  std::string title;   ///< mission title
  const batch::Method* method;
  std::filesystem::path folder;              ///< folder of the result
  std::optional<batch::TrialRecord> record;  ///< nullopt if the result is missing
};

/// All items whose missions are readable, ordered by mission, variant, planner and seed.
struct Collected {
  std::vector<CollectedItem> items;

  std::size_t done() const;
  /// Returns "; missing 3, 7, ..." with up to 20 items, or an empty string if the results are
  /// complete.
  std::string missing_text() const;
};

/// Executes the items of a campaign according to the options: all locally, one task, or a scheduler
/// job.
class BatchRun {
 public:
  /// Stages and commits the collected results and returns the exit code. The manifest and the
  /// timings are already staged.
  using Collect = std::function<int(const Collected&, geometry::OutputFolder&)>;

  /// `command` is the command name.
  BatchRun(const BatchOptions& options, std::string command, batch::CampaignFile file,
           std::filesystem::path out, const Console& console);

  /// Runs the items and collects the results. Returns the exit code.
  int run(const Collect& collect);

  const batch::Manifest& manifest() const { return manifest_; }
  SurveyRunner& runner() { return runner_; }

 private:
  std::size_t work_on(const batch::ItemRange& range);
  Collected collected();
  void report_failure(const Error& error, std::size_t items, bool is_alone);

  const BatchOptions& options_;
  const Console& console_;
  std::string command_;
  batch::Manifest manifest_;
  std::filesystem::path out_;
  unsigned threads_;
  SurveyRunner runner_;
};

/// Terminates the program if it does not end soon after a signal, because scene loading cannot be
/// interrupted. No results are lost: they are committed by a single rename.
class SignalWatchdog {
 public:
  explicit SignalWatchdog(const Console& console);
  ~SignalWatchdog();

 private:
  struct Watcher;
  PendingResultsGuard results_;
  std::unique_ptr<Watcher> watcher_;
};

}  // namespace skycap::missions::cli
