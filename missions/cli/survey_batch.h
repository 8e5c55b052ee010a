/// Many surveys as a verb: run here with a line that says how far they are, or as tasks of an
/// engine for many jobs. For plan --trials, benchmark, campaign and district.
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
#include "missions/cli/console.h"
#include "missions/cli/verb_options.h"

namespace skycap::missions::cli {

/// Runs surveys with a line that says how many are done and how long the rest will take, from the
/// mean duration of surveys of the same kind (a mission and its planner), or of any where none of
/// that kind is over yet.
class SurveyRunner {
 public:
  /// `verb` begins the line; up to `threads` surveys run at a time, zero: as many as there are
  /// processors. With `has_report` packages get their pages.
  SurveyRunner(std::string verb, const Console& console, bool is_quiet, unsigned threads,
               bool has_report = false);

  /// See batch::run_items(): of failures `failed` is told, if there is one.
  batch::Records run(const std::vector<batch::Item>& items,
                     const std::function<void(const Error&)>& failed = {});

  /// So many surveys of a kind will come, unless they turn out to be finished. run() counts those
  /// that were not announced.
  void announce(const std::string& kind, std::size_t surveys);

  void say(const std::string& text);
  void clear();

 private:
  struct Kind {
    std::size_t announced = 0, left = 0, done = 0;
    double seconds = 0.0;
  };

  void survey_done(const std::string& kind, double seconds);
  double work_left() const;

  std::string verb_;
  const Console& console_;
  unsigned threads_;
  bool has_report_;
  ProgressLine line_;
  std::mutex mutex_;
  std::size_t total_ = 0;
  Kind of_any_;
  std::map<std::string, Kind> kinds_;
};

struct ItemOptions {
  std::filesystem::path file;                ///< that says what is surveyed
  std::optional<std::filesystem::path> out;  ///< default: results/NAME
  TaskOptions task;
  std::optional<unsigned> threads;  ///< default: all processors, of one task one
  bool lists = false;
  bool has_report = true;
  bool is_quiet = false;

  std::filesystem::path folder(const std::string& name) const;
};

/// Adds all of them; `what` the file is called.
void add_item_options(CLI::App& verb, ItemOptions& options, const std::string& what);

/// What there is of an item.
struct CollectedItem {
  std::size_t number;  ///< in the manifest
  std::string title;   ///< of its mission
  const batch::Contestant* contestant;
  std::filesystem::path folder;              ///< of its result
  std::optional<batch::TrialRecord> record;  ///< nothing: it is missing
};

/// All items of missions that can be read, by mission, variant, planner and seed.
struct Collected {
  std::vector<CollectedItem> items;

  std::size_t done() const;
  /// "; missing 3, 7, ...", of the first twenty; nothing of none.
  std::string missing_text() const;
};

/// The items of a campaign as the options ask for: all here, one task, or a job of an engine.
class ItemRun {
 public:
  /// Stages and commits the results of what was collected; returns the exit code. The manifest and
  /// the times are staged already.
  using Collect = std::function<int(const Collected&, geometry::OutputFolder&)>;

  /// `verb` as on the command line.
  ItemRun(const ItemOptions& options, std::string verb, batch::CampaignFile file,
          std::filesystem::path out, const Console& console);

  /// Returns the exit code.
  int run(const Collect& collect);

  const batch::Manifest& manifest() const { return manifest_; }
  SurveyRunner& runner() { return runner_; }

 private:
  std::size_t work_on(const batch::ItemRange& range);
  Collected collected();
  void tell_failure(const Error& error, std::size_t items, bool is_alone);

  const ItemOptions& options_;
  const Console& console_;
  std::string verb_;
  batch::Manifest manifest_;
  std::filesystem::path out_;
  unsigned threads_;
  SurveyRunner runner_;
};

/// Ends the program when it does not end by itself soon after a signal: a large scene that is being
/// made ready cannot be stopped. Nothing is lost by it, since results appear whole by one renaming.
class LastResort {
 public:
  explicit LastResort(const Console& console);
  ~LastResort();

 private:
  struct Watcher;
  HoldsResults results_;
  std::unique_ptr<Watcher> watcher_;
};

}  // namespace skycap::missions::cli
