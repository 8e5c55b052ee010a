#include "missions/cli/tasks.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "missions/batch/campaign/submission.h"

namespace skycap::missions::cli {

batch::ItemRange items_of(const TaskOptions& options, std::size_t items, const Console& console) {
  const std::size_t task = batch::task_index(options.index.value(), batch::program_environment());
  const batch::ItemRange range =
      batch::items_of_task(task, std::max<std::size_t>(1, options.chunk), items);
  if (range.size() == 0) {
    warn(console, fmt::format("task {} has no runs; there are {}", task, items));
  }
  return range;
}

std::string missing_text(const std::vector<std::size_t>& missing) {
  constexpr std::size_t most = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, missing.size()); ++i) {
    text += (i == 0 ? "; missing " : ", ") + std::to_string(missing[i]);
  }
  return missing.size() > most ? text + ", ..." : text;
}

int submit_job(const TaskOptions& options, batch::JobRequest job, geometry::OutputFolder& folder,
               bool is_quiet, const Console& console, const std::function<int()>& collect) {
  job.command.insert(job.command.begin(), std::filesystem::read_symlink("/proc/self/exe"));
  job.chunk = options.chunk;
  ProgressLine progress(console, is_quiet);
  progress.show("waiting for " + *options.engine);
  const auto tell = [&](const std::string& what) {
    progress.clear();
    warn(console, what);
  };
  const batch::Submission submission =
      batch::submit(batch::engine_named(*options.engine), job, folder, console.stop, tell);
  progress.clear();
  if (!submission.is_queued) {
    return console.stop.stop_requested() ? interrupted_exit_code(console) : collect();
  }
  if (!submission.job.empty() && !is_quiet) {
    console.out << fmt::format("Slurm job {}: {} tasks of {} runs\nresults: {}\n", submission.job,
                               submission.tasks.tasks, submission.tasks.chunk,
                               folder.path().string())
                << std::flush;
  }
  return submission.is_accepted ? 0 : 1;
}

}  // namespace skycap::missions::cli
