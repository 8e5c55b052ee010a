#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "geometry/parallel.h"
#include "missions/campaign/item_runner.h"
#include "missions/campaign/manifest_batches.h"
#include "missions/campaign/tables.h"
#include "missions/verbs/survey_progress.h"
#include "missions/verbs/tasks.h"
#include "missions/verbs/verb_options.h"
#include "missions/verbs/write_page.h"

namespace skycap::missions::verbs {
namespace {

namespace fs = std::filesystem;

struct CampaignOptions {
  fs::path file;
  std::optional<fs::path> out;  ///< default: results/NAME
  TaskOptions task;
  std::optional<unsigned> threads;  ///< default: all processors, of one task one
  bool lists = false;
  bool has_report = true;
  bool is_quiet = false;
};

class CampaignVerb {
 public:
  CampaignVerb(const CampaignOptions& options, const Console& console)
      : options_(options),
        console_(console),
        manifest_(campaign::read_campaign(options.file)),
        out_(options.out.value_or(fs::path("results") / manifest_.file().name)),
        threads_(options.threads.value_or(options.task.index ? 1 : 0)),
        progress_("campaign", console, options.is_quiet, geometry::thread_count(threads_)) {}

  int run() {
    if (options_.lists) return console_.out << manifest_.text() << std::flush, 0;
    if (options_.task.engine) return submit();
    const campaign::ItemRange all{0, manifest_.size()};
    if (options_.task.index) return run_task();
    geometry::OutputFolder folder(out_);
    if (!options_.task.collects) work_on(all, true);
    if (console_.stop.stop_requested()) return interrupted_exit_code(console_);
    return collect(folder);
  }

 private:
  /// The items of one task. Others may be at other items of the same campaign.
  int run_task() {
    const campaign::ItemRange range = items_of(options_.task, manifest_.size(), console_);
    if (range.size() == 0) return 0;
    const std::size_t done = work_on(range, true);
    if (console_.stop.stop_requested()) return interrupted_exit_code(console_);
    return done == range.size() ? 0 : 1;
  }

  /// Runs what is not finished, or only reads what is; returns how many items are done. What fails
  /// is told of; others go on. Throws Error if there is but one item.
  std::size_t work_on(const campaign::ItemRange& range, bool runs) {
    const bool is_alone = range.size() == 1;
    const auto tell = [&](const Error& error, std::size_t items) {
      if (is_alone) throw Error(error.kind(), error.what());
      progress_.clear();
      warn(console_, items == 1 ? std::string(error.what())
                                : fmt::format("{} items: {}", items, error.what()));
    };
    const campaign::RunEvents events{
        .unfinished = [&](const campaign::Item& item) { progress_.expect(kind_of(item), 1); },
        .preparing =
            [&](const campaign::Setup& setup) {
              progress_.say(setup.title + ": measuring what could be covered at all");
            },
        .done =
            [&](const campaign::Item& item, const benchmark::TrialRecord& record) {
              progress_.survey_done(kind_of(item), record.run.wall_time);
            },
        .failed = [&](const campaign::Item&, const Error& error) { tell(error, 1); }};
    std::size_t done = 0;
    if (runs) expect(range);
    const auto work = [&](const campaign::Batch& batch) {
      // The runner says of how many this is not true.
      for (const campaign::Item& item : batch.items) {
        if (runs) progress_.expect_no_more(kind_of(item));
      }
      const auto records = runs ? campaign::run_items(batch.items, threads_, console_.stop, events)
                                : campaign::finished_items(batch.items);
      for (std::size_t i = 0; i < records.size(); ++i) done += records[i] ? 1 : 0;
      if (!runs) keep(batch, records);
    };
    campaign::for_each_batch(manifest_, out_, range,
                             {work, tell, [&](const std::string& what) { progress_.say(what); }});
    progress_.clear();
    return done;
  }

  /// All of the range, before it is known which are finished.
  void expect(const campaign::ItemRange& range) {
    for (std::size_t i = 0; i < manifest_.entries(); ++i) {
      const campaign::ManifestEntry entry = manifest_.entry(i);
      progress_.expect(entry.title + " " + entry.planner,
                       campaign::numbers_of_entry(manifest_, i, range).size());
    }
  }

  /// What the progress line tells apart.
  std::string kind_of(const campaign::Item& item) const {
    const bool is_own = manifest_.file().planners.empty();
    return item.setup->title + " " + (is_own ? "" : item.setup->contestant->name);
  }

  /// Takes the records of a batch in for the tables.
  void keep(const campaign::Batch& batch,
            const std::vector<std::optional<benchmark::TrialRecord>>& records) {
    const campaign::Setup* before = nullptr;
    for (std::size_t i = 0; i < records.size(); ++i) {
      const campaign::Setup* setup = batch.items[i].setup.get();
      if (setup != before) cells_.push_back({setup->title, setup->contestant->name, {}});
      before = setup;
      if (!records[i]) {
        missing_.push_back(batch.numbers[i]);
        continue;
      }
      cells_.back().trials.push_back(records[i]->trial);
      times_.push_back({batch.numbers[i], records[i]->trial.planning_time, records[i]->run});
    }
  }

  /// The tables of what is there. The same items give the same tables, whatever ran where.
  int collect(geometry::OutputFolder& folder) {
    const std::size_t done = work_on({0, manifest_.size()}, false);
    std::ranges::sort(times_, {}, &campaign::ItemTimes::number);
    folder.write("manifest.jsonl", manifest_.text());
    folder.write("times.csv", campaign::times_csv(times_));
    std::ranges::sort(missing_);
    const std::string markdown =
        campaign::stage_tables(cells_, manifest_.file().name, benchmark::Times::left_out, folder);
    write_page("results.json", options_.has_report, folder, console_);
    folder.commit();
    if (!options_.is_quiet) {
      console_.out << markdown << fmt::format("\n{} of {} items", done, manifest_.size())
                   << missing_text(missing_) << "\nresults: " << out_.string() << "\n"
                   << std::flush;
    }
    return done == manifest_.size() ? 0 : 1;
  }

  int submit() {
    const campaign::JobRequest job{
        .command = {"campaign", fs::absolute(options_.file), "--out", fs::absolute(out_)},
        .out = fs::absolute(out_),
        .title = "Campaign " + manifest_.file().name,
        .name = manifest_.file().name,
        .items = manifest_.size(),
        .jobs = geometry::thread_count(threads_)};
    geometry::OutputFolder folder(out_);
    folder.write("manifest.jsonl", manifest_.text());
    return submit_job(options_.task, job, folder, options_.is_quiet, console_,
                      [&] { return collect(folder); });
  }

  const CampaignOptions& options_;
  const Console& console_;
  campaign::Manifest manifest_;
  fs::path out_;
  unsigned threads_;
  SurveyProgress progress_;
  std::vector<benchmark::BenchmarkCell> cells_;
  std::vector<campaign::ItemTimes> times_;
  std::vector<std::size_t> missing_;
};

/// Ends the program when it does not end by itself soon after a signal: a large scene that is being
/// made ready cannot be stopped. Nothing is lost by it, since results appear whole by one renaming.
class LastResort {
 public:
  explicit LastResort(const Console& console) {
    if (console.ending_signal == nullptr) return;
    watcher_ = std::jthread([this, &console](const std::stop_token& over) {
      const std::stop_callback told(console.stop, [this] {
        const std::lock_guard guard(mutex_);
        changed_.notify_all();
      });
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, over, [&] { return console.stop.stop_requested(); })) return;
      changed_.wait_for(lock, over, std::chrono::milliseconds(1500), [] { return false; });
      if (!over.stop_requested()) std::_Exit(interrupted_exit_code(console));
    });
  }

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::jthread watcher_;
};

int campaign_verb(const CampaignOptions& options, const Console& console) {
  const HoldsResults results(console);
  const LastResort last_resort(console);
  return CampaignVerb(options, console).run();
}

}  // namespace

void add_campaign(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "campaign", "Run missions x planners x seeds x changes, here or on an engine for many jobs");
  const auto options = std::make_shared<CampaignOptions>();
  verb->add_option("file", options->file, "Campaign file (docs/campaigns.md)")->required();
  verb->add_option(
      "--out", options->out,
      "Folder for the results; default results/NAME. What is complete there is not run "
      "again");
  verb->add_option("--threads", options->threads,
                   "Items at a time, 0 for all processors; default 0, with --index 1")
      ->check(CLI::Range(0, 1024));
  auto* lists = verb->add_flag("--list", options->lists, "Print the manifest and run nothing");
  for (CLI::Option* other : add_task_options(*verb, options->task, "item")) lists->excludes(other);
  verb->add_flag("!--no-report", options->has_report, "Leave out the page");
  verb->add_flag("--quiet", options->is_quiet, "Print nothing but warnings and errors");
  run(*verb, options, campaign_verb, console, action);
}

}  // namespace skycap::missions::verbs
