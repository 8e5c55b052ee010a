#include "missions/cli/survey_batch.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <stop_token>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "missions/batch/benchmark/benchmark_report.h"
#include "missions/cli/tasks.h"
#include "missions/cli/write_page.h"
#include "missions/package/package.h"

namespace skycap::missions::cli {

namespace fs = std::filesystem;

SurveyRunner::SurveyRunner(std::string command, const Console& console, bool is_quiet,
                           unsigned threads, bool has_report)
    : command_(std::move(command)),
      console_(console),
      threads_(threads),
      has_report_(has_report),
      line_(console, is_quiet) {}

batch::Records SurveyRunner::run(const std::vector<batch::BatchItem>& items,
                                 const std::function<void(const Error&)>& failed) {
  for (const batch::BatchItem& item : items) {  // completed surveys are not counted
    Kind& kind = kinds_[item.setup->kind];
    if (kind.announced == 0) continue;
    --kind.announced;
    --kind.left;
    --total_;
  }
  const auto preparing = [&](const batch::Setup& setup) {
    show_status(setup.title + ": computing attainable coverage");
  };
  const auto done = [&](const batch::BatchItem& item, const batch::TrialRecord& record) {
    survey_done(item.setup->kind, record.run.wall_time);
  };
  const auto packaged = [&](geometry::OutputFolder& folder) {
    write_page(package::summary_name, has_report_, folder, console_);
  };
  const auto unfinished = [&](const batch::BatchItem& item) {
    const std::lock_guard lock(mutex_);
    ++kinds_[item.setup->kind].left;
    ++total_;
  };
  return batch::run_items(items, threads_, console_.stop,
                          {unfinished, preparing, done, packaged, failed});
}

void SurveyRunner::announce(const std::string& kind, std::size_t surveys) {
  const std::lock_guard lock(mutex_);
  kinds_[kind].announced += surveys;
  kinds_[kind].left += surveys;
  total_ += surveys;
}

void SurveyRunner::show_status(const std::string& text) {
  const std::lock_guard lock(mutex_);
  line_.show(text);
}

void SurveyRunner::clear() {
  const std::lock_guard lock(mutex_);
  line_.clear();
}

void SurveyRunner::survey_done(const std::string& kind, double seconds) {
  const std::lock_guard lock(mutex_);
  Kind& own = kinds_[kind];
  if (own.left > 0) --own.left;
  for (Kind* known : {&own, &all_kinds_}) {
    known->seconds += seconds;
    ++known->done;
  }
  const auto minutes =
      static_cast<int>(std::ceil(work_left() / geometry::thread_count(threads_) / 60.0));
  line_.show(fmt::format("{}: {} of {} surveys, about {} min left; {}", command_, all_kinds_.done,
                         total_, minutes, kind));
}

double SurveyRunner::work_left() const {
  double work = 0.0;
  for (const auto& [name, kind] : kinds_) {
    const Kind& known = kind.done > 0 ? kind : all_kinds_;
    work += static_cast<double>(kind.left) * known.seconds / static_cast<double>(known.done);
  }
  return work;
}

fs::path BatchOptions::folder(const std::string& name) const {
  return out.value_or(fs::path("results") / name);
}

std::size_t Collected::done() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      items, [](const CollectedItem& item) { return item.record.has_value(); }));
}

std::string Collected::missing_text() const {
  std::vector<std::size_t> missing;
  for (const CollectedItem& item : items) {
    if (!item.record) missing.push_back(item.number);
  }
  std::ranges::sort(missing);
  return cli::missing_text(missing);
}

BatchRun::BatchRun(const BatchOptions& options, std::string command, batch::CampaignFile file,
                   fs::path out, const Console& console)
    : options_(options),
      console_(console),
      command_(std::move(command)),
      manifest_(std::move(file)),
      out_(std::move(out)),
      threads_(options.threads.value_or(options.task.index ? 1 : 0)),
      runner_(command_, console, options.is_quiet, threads_, options.has_report) {}

int BatchRun::run(const Collect& collect) {
  if (options_.lists) return console_.out << manifest_.text() << std::flush, 0;
  std::string title = command_ + " " + manifest_.file().name;
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  const TaskWork work{
      .job = {.command = {command_, fs::absolute(options_.file), "--out", fs::absolute(out_)},
              .out = out_,
              .title = std::move(title),
              .name = manifest_.file().name,
              .items = manifest_.size(),
              .jobs = geometry::thread_count(threads_)},
      .is_quiet = options_.is_quiet,
      .submitting = [&](auto& folder) { folder.write("manifest.jsonl", manifest_.text()); },
      .work = [&](const batch::ItemRange& range) { return work_on(range); },
      .collect =
          [&](geometry::OutputFolder& folder) {
            const Collected all = collected();
            std::vector<batch::ItemTimes> times;
            for (const CollectedItem& item : all.items) {
              if (!item.record) continue;
              times.push_back({item.number, item.record->trial.planning_time, item.record->run});
            }
            std::ranges::sort(times, {}, &batch::ItemTimes::number);
            folder.write("manifest.jsonl", manifest_.text());
            folder.write("times.csv", batch::times_csv(times));
            return collect(all, folder);
          }};
  return run_tasks(work, options_.task, console_);
}

void BatchRun::report_failure(const Error& error, std::size_t items, bool is_alone) {
  if (is_alone) throw Error(error.kind(), error.what());
  runner_.clear();
  warn(console_,
       items == 1 ? std::string(error.what()) : fmt::format("{} items: {}", items, error.what()));
}

/// Runs pending items and returns the number of completed items. Failures are reported while other
/// items continue. Throws Error if the range has a single item.
std::size_t BatchRun::work_on(const batch::ItemRange& range) {
  const auto report = [&](const Error& error, std::size_t items) {
    report_failure(error, items, range.size() == 1);
  };
  for (std::size_t i = 0; i < manifest_.entries(); ++i) {
    runner_.announce(manifest_.entry(i).kind(), manifest_.entry_run_numbers(i, range).size());
  }
  std::size_t done = 0;
  const auto work = [&](const std::vector<batch::BatchItem>& items) {
    for (const auto& record : runner_.run(items, [&](const Error& error) { report(error, 1); })) {
      done += record ? 1 : 0;
    }
  };
  batch::for_each_batch(manifest_, out_, range, {work, report, [&](const std::string& what) {
                                                   runner_.show_status(what);
                                                 }});
  runner_.clear();
  return done;
}

/// Returns the existing results. They do not depend on which machines ran the items.
Collected BatchRun::collected() {
  Collected all;
  const auto keep = [&](const std::vector<batch::BatchItem>& items) {
    batch::Records records = batch::finished_items(items);
    for (std::size_t i = 0; i < items.size(); ++i) {
      all.items.push_back({items[i].number, items[i].setup->title, items[i].setup->method,
                           items[i].record.parent_path(), std::move(records[i])});
    }
  };
  const auto failed = [&](const Error& error, std::size_t items) {
    report_failure(error, items, manifest_.size() == 1);
  };
  batch::for_each_batch(
      manifest_, out_, {0, manifest_.size()},
      {keep, failed, [&](const std::string& what) { runner_.show_status(what); }});
  runner_.clear();
  return all;
}

struct SignalWatchdog::Watcher {
  explicit Watcher(const Console& console) {
    thread = std::jthread([this, &console](const std::stop_token& over) {
      const std::stop_callback on_stop(console.stop, [this] {
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

SignalWatchdog::SignalWatchdog(const Console& console) : results_(console) {
  if (console.termination_signal != nullptr) watcher_ = std::make_unique<Watcher>(console);
}

SignalWatchdog::~SignalWatchdog() = default;

void add_batch_options(CLI::App& command, BatchOptions& options, const std::string& what) {
  command.add_option("file", options.file, what)->required();
  command.add_option(
      "--out", options.out,
      "Folder for the results (default: results/NAME). Completed runs are not repeated");
  command
      .add_option("--threads", options.threads,
                  "Number of parallel runs; 0: all processors (default: 0; with --index: 1)")
      ->check(CLI::Range(0, 1024));
  auto* lists = command.add_flag("--list", options.lists, "Print the runs and exit");
  for (CLI::Option* other : add_task_options(command, options.task, "run")) lists->excludes(other);
  command.add_flag("!--no-report", options.has_report, "Do not write the HTML reports");
  command.add_flag("--quiet", options.is_quiet, "Print warnings and errors only");
}

}  // namespace skycap::missions::cli
