#include "missions/cli/items/item_run.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "missions/batch/campaign/item_runner.h"
#include "missions/cli/tasks.h"
#include "missions/cli/write_page.h"
#include "missions/package/package.h"

namespace skycap::missions::cli {

namespace fs = std::filesystem;

fs::path ItemOptions::folder(const std::string& name) const {
  return out.value_or(fs::path("results") / name);
}

ItemRun::ItemRun(const ItemOptions& options, batch::CampaignFile file, fs::path out, ItemVerb verb,
                 const Console& console)
    : options_(options),
      console_(console),
      manifest_(std::move(file)),
      out_(std::move(out)),
      verb_(std::move(verb)),
      threads_(options.threads.value_or(options.task.index ? 1 : 0)),
      progress_(verb_.name, console, options.is_quiet, geometry::thread_count(threads_)) {}

int ItemRun::run() {
  if (options_.lists) return console_.out << manifest_.text() << std::flush, 0;
  if (options_.task.engine) return submit();
  if (options_.task.index) return run_task();
  geometry::OutputFolder folder(out_);
  if (!options_.task.collects) work_on({0, manifest_.size()}, true);
  if (console_.stop.stop_requested()) return interrupted_exit_code(console_);
  return collect(folder);
}

/// The items of one task. Others may be at other items of the same campaign.
int ItemRun::run_task() {
  const batch::ItemRange range = items_of(options_.task, manifest_.size(), console_);
  if (range.size() == 0) return 0;
  const std::size_t done = work_on(range, true);
  if (console_.stop.stop_requested()) return interrupted_exit_code(console_);
  return done == range.size() ? 0 : 1;
}

/// Runs what is not finished, or only reads what is; returns how many items are done. What fails
/// is told of; others go on. Throws Error if there is but one item.
std::size_t ItemRun::work_on(const batch::ItemRange& range, bool runs) {
  const bool is_alone = range.size() == 1;
  const auto tell = [&](const Error& error, std::size_t items) {
    if (is_alone) throw Error(error.kind(), error.what());
    progress_.clear();
    warn(console_,
         items == 1 ? std::string(error.what()) : fmt::format("{} items: {}", items, error.what()));
  };
  const batch::RunEvents events{
      .unfinished = [&](const batch::Item& item) { progress_.expect(kind_of(item), 1); },
      .preparing =
          [&](const batch::Setup& setup) {
            progress_.say(setup.title + ": computing attainable coverage");
          },
      .done =
          [&](const batch::Item& item, const batch::TrialRecord& record) {
            progress_.survey_done(kind_of(item), record.run.wall_time);
          },
      .packaged =
          [&](const batch::Item&, geometry::OutputFolder& folder) {
            write_page(package::summary_name, options_.has_report, folder, console_);
          },
      .failed = [&](const batch::Item&, const Error& error) { tell(error, 1); }};
  std::size_t done = 0;
  if (runs) expect(range);
  const auto work = [&](const batch::Batch& batch) {
    // The runner says of how many this is not true.
    for (const batch::Item& item : batch.items) {
      if (runs) progress_.expect_no_more(kind_of(item));
    }
    const auto records = runs ? batch::run_items(batch.items, threads_, console_.stop, events)
                              : batch::finished_items(batch.items);
    for (std::size_t i = 0; i < records.size(); ++i) done += records[i] ? 1 : 0;
    if (!runs) keep(batch, records);
  };
  batch::for_each_batch(manifest_, out_, range,
                        {work, tell, [&](const std::string& what) { progress_.say(what); }});
  progress_.clear();
  return done;
}

/// All of the range, before it is known which are finished.
void ItemRun::expect(const batch::ItemRange& range) {
  for (std::size_t i = 0; i < manifest_.entries(); ++i) {
    const batch::ManifestEntry entry = manifest_.entry(i);
    progress_.expect(entry.title + " " + entry.planner,
                     batch::numbers_of_entry(manifest_, i, range).size());
  }
}

/// What the progress line tells apart.
std::string ItemRun::kind_of(const batch::Item& item) const {
  const bool is_own = manifest_.file().planners.empty();
  return item.setup->title + " " + (is_own ? "" : item.setup->contestant->name);
}

/// The records of a batch, for the times and for the verb's own results.
void ItemRun::keep(const batch::Batch& batch, const Records& records) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i]) {
      times_.push_back({batch.numbers[i], records[i]->trial.planning_time, records[i]->run});
    } else {
      missing_.push_back(batch.numbers[i]);
    }
  }
  verb_.keep(batch, records);
}

/// The results of what is there. The same items give the same, whatever ran where.
int ItemRun::collect(geometry::OutputFolder& folder) {
  work_on({0, manifest_.size()}, false);
  std::ranges::sort(times_, {}, &batch::ItemTimes::number);
  folder.write("manifest.jsonl", manifest_.text());
  folder.write("times.csv", batch::times_csv(times_));
  return verb_.collect(folder);
}

std::string ItemRun::missing() const {
  std::vector<std::size_t> missing = missing_;
  std::ranges::sort(missing);
  return missing_text(missing);
}

int ItemRun::submit() {
  std::string title = verb_.name + " " + manifest_.file().name;
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  const batch::JobRequest job{
      .command = {verb_.name, fs::absolute(options_.file), "--out", fs::absolute(out_)},
      .out = fs::absolute(out_),
      .title = std::move(title),
      .name = manifest_.file().name,
      .items = manifest_.size(),
      .jobs = geometry::thread_count(threads_)};
  geometry::OutputFolder folder(out_);
  folder.write("manifest.jsonl", manifest_.text());
  return submit_job(options_.task, job, folder, options_.is_quiet, console_,
                    [&] { return collect(folder); });
}

struct LastResort::Watcher {
  explicit Watcher(const Console& console) {
    thread = std::jthread([this, &console](const std::stop_token& over) {
      const std::stop_callback told(console.stop, [this] {
        const std::lock_guard guard(mutex);
        changed.notify_all();
      });
      std::unique_lock lock(mutex);
      if (!changed.wait(lock, over, [&] { return console.stop.stop_requested(); })) return;
      changed.wait_for(lock, over, std::chrono::milliseconds(1500), [] { return false; });
      if (!over.stop_requested()) std::_Exit(interrupted_exit_code(console));
    });
  }

  std::mutex mutex;
  std::condition_variable_any changed;
  std::jthread thread;
};

LastResort::LastResort(const Console& console) {
  if (console.ending_signal != nullptr) watcher_ = std::make_unique<Watcher>(console);
}

LastResort::~LastResort() = default;

void add_item_options(CLI::App& verb, ItemOptions& options, const std::string& what) {
  verb.add_option("file", options.file, what)->required();
  verb.add_option("--out", options.out,
                  "Folder for the results (default: results/NAME). Complete runs are not repeated");
  verb.add_option("--threads", options.threads,
                  "Number of parallel runs, 0: all processors (default: 0; with --index: 1)")
      ->check(CLI::Range(0, 1024));
  auto* lists = verb.add_flag("--list", options.lists, "Print the runs and exit");
  for (CLI::Option* other : add_task_options(verb, options.task, "run")) lists->excludes(other);
  verb.add_flag("!--no-report", options.has_report, "Do not write the HTML reports");
  verb.add_flag("--quiet", options.is_quiet, "Print warnings and errors only");
}

}  // namespace skycap::missions::cli
