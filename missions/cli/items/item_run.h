/// What verbs of many surveys share: all items here, some as a task of an engine, or a job for one.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/batch/campaign/manifest_batches.h"
#include "missions/batch/campaign/tables.h"
#include "missions/cli/survey_progress.h"
#include "missions/cli/verb_options.h"

namespace skycap::missions::cli {

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

using Records = std::vector<std::optional<batch::TrialRecord>>;

/// What one verb makes of its items.
struct ItemVerb {
  std::string name;  ///< as on the command line
  /// Takes in the records of a batch; of all items, before `collect`.
  std::function<void(const batch::Batch&, const Records&)> keep;
  /// Stages the results of what was kept and commits them; returns the exit code. The manifest and
  /// the times are staged already.
  std::function<int(geometry::OutputFolder&)> collect;
};

/// Runs once.
class ItemRun {
 public:
  ItemRun(const ItemOptions& options, batch::CampaignFile file, std::filesystem::path out,
          ItemVerb verb, const Console& console);

  /// What the options ask for. Returns the exit code.
  int run();

  const batch::Manifest& manifest() const { return manifest_; }
  SurveyProgress& progress() { return progress_; }

  /// Of what was kept: how many items are complete, and a list of the others for the user.
  std::size_t done() const { return times_.size(); }
  std::string missing() const;

 private:
  int run_task();
  std::size_t work_on(const batch::ItemRange& range, bool runs);
  void expect(const batch::ItemRange& range);
  std::string kind_of(const batch::Item& item) const;
  void keep(const batch::Batch& batch, const Records& records);
  int collect(geometry::OutputFolder& folder);
  int submit();

  const ItemOptions& options_;
  const Console& console_;
  batch::Manifest manifest_;
  std::filesystem::path out_;
  ItemVerb verb_;
  unsigned threads_;
  SurveyProgress progress_;
  std::vector<batch::ItemTimes> times_;
  std::vector<std::size_t> missing_;
};

/// Ends the program when it does not end by itself soon after a signal: a large scene that is being
/// made ready cannot be stopped. Nothing is lost by it, since results appear whole by one renaming.
class LastResort {
 public:
  explicit LastResort(const Console& console);
  ~LastResort();

 private:
  struct Watcher;
  std::unique_ptr<Watcher> watcher_;
};

}  // namespace skycap::missions::cli
