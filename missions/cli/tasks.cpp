#include "missions/cli/tasks.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "missions/package/package.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

/// Submits the job to a scheduler. The results are collected here if the job is complete, or by a
/// second job if it is queued.
int submit(const TaskWork& work, const TaskOptions& options, const Console& console) {
  geometry::OutputFolder folder(work.job.out);
  if (work.submitting) work.submitting(folder);
  batch::JobRequest job = work.job;
  job.command.insert(job.command.begin(), fs::read_symlink("/proc/self/exe"));
  job.out = fs::absolute(job.out);
  job.chunk = options.chunk;
  ProgressLine progress(console, work.is_quiet);
  progress.show("waiting for " + *options.engine);
  const auto report = [&](const std::string& what) {
    progress.clear();
    warn(console, what);
  };
  const batch::Submission submission =
      batch::submit(batch::engine_named(*options.engine), job, folder, console.stop, report);
  progress.clear();
  if (!submission.is_queued) {
    return console.stop.stop_requested() ? interrupted_exit_code(console) : work.collect(folder);
  }
  if (!submission.job.empty() && !work.is_quiet) {
    console.out << fmt::format("Slurm job {}: {} tasks, up to {} runs per task\nresults: {}\n",
                               submission.job, submission.tasks.tasks, submission.tasks.chunk,
                               folder.path().string())
                << std::flush;
  }
  return submission.is_accepted ? 0 : 1;
}

/// Runs the items of one task. Other tasks of the same work may run concurrently.
int run_task(const TaskWork& work, const TaskOptions& options, const Console& console) {
  const std::size_t task = batch::task_index(options.index.value(), batch::program_environment());
  const batch::ItemRange range =
      batch::items_in_task(task, std::max<std::size_t>(1, options.chunk), work.job.items);
  if (range.size() == 0) {
    warn(console,
         fmt::format("task {} has no runs; the total number of runs is {}", task, work.job.items));
    return 0;
  }
  const std::size_t done = work.work(range);
  if (console.stop.stop_requested()) return interrupted_exit_code(console);
  return done == range.size() ? 0 : 1;
}

}  // namespace

std::string missing_text(const std::vector<std::size_t>& missing) {
  constexpr std::size_t max = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(max, missing.size()); ++i) {
    text += (i == 0 ? "; missing " : ", ") + std::to_string(missing[i]);
  }
  return missing.size() > max ? text + ", ..." : text;
}

int run_tasks(const TaskWork& work, const TaskOptions& options, const Console& console) {
  if (options.engine) return submit(work, options, console);
  if (options.index) return run_task(work, options, console);
  geometry::OutputFolder folder(work.job.out);
  if (options.collects && work.is_collected && work.is_collected()) {
    warn(console, work.job.out.string() + ": contains no pieces; its results are complete");
    return 0;
  }
  if (!options.collects) work.work({0, work.job.items});
  return console.stop.stop_requested() ? interrupted_exit_code(console) : work.collect(folder);
}

fs::path shards_folder(const fs::path& results) { return results / "pieces"; }

fs::path shard_folder(const fs::path& results, std::size_t number, std::size_t shards) {
  return shards_folder(results) / fmt::format("{}_of_{}", number, shards);
}

int run_shards(const batch::JobRequest& job, const TaskOptions& options, bool is_quiet,
               const std::string& summary,
               const std::function<std::unique_ptr<ShardedJob>()>& begin, const Console& console) {
  std::unique_ptr<ShardedJob> begun;
  const auto work = [&]() -> ShardedJob& {
    if (!begun) begun = begin();
    return *begun;
  };
  const auto process_shards = [&](const batch::ItemRange& range) {
    std::size_t number = range.first;
    while (number < range.end && work().process_shard(number)) ++number;
    return number - range.first;
  };
  const auto is_collected = [&] {
    std::error_code ignored;
    return !fs::exists(shards_folder(job.out), ignored) &&
           package::is_complete_result(job.out / summary);
  };
  const auto collect = [&](geometry::OutputFolder& folder) {
    std::vector<std::size_t> missing;
    std::error_code ignored;
    for (std::size_t number = 0; number < job.items; ++number) {
      const fs::path shard = shard_folder(job.out, number, job.items);
      if (fs::exists(shard, ignored)) geometry::finish_commit(shard);
      if (!work().load_shard(number)) missing.push_back(number);
    }
    if (!missing.empty()) {
      warn(console, fmt::format("{} of {} pieces are complete{}", job.items - missing.size(),
                                job.items, missing_text(missing)));
      return 1;
    }
    const int exit_code = work().join(folder);
    if (exit_code == 0) fs::remove_all(shards_folder(job.out), ignored);
    return exit_code;
  };
  return run_tasks({job, is_quiet, {}, process_shards, is_collected, collect}, options, console);
}

}  // namespace skycap::missions::cli
