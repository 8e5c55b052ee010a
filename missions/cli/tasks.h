/// Runs numbered items of work: all locally, or as tasks of a scheduler.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/batch/campaign/task_job.h"
#include "missions/cli/commands.h"

namespace skycap::missions::cli {

/// Returns "; missing 3, 7, ..." with up to 20 items, or an empty string for an empty list.
std::string missing_text(const std::vector<std::size_t>& missing);

struct TaskWork {
  /// Job description. Its command starts with the command name; its chunk size follows from the
  /// options.
  batch::JobRequest job;
  bool is_quiet = false;
  std::function<void(geometry::OutputFolder&)> submitting{};  ///< stages additional files of a job
  /// Runs incomplete items of a range until a stop is requested. Returns the number of complete
  /// items.
  std::function<std::size_t(const batch::ItemRange&)> work{};
  /// Returns whether the results are complete and the pieces removed.
  std::function<bool()> is_collected{};
  /// Creates and commits results from all complete items. Returns the exit code.
  std::function<int(geometry::OutputFolder&)> collect{};
};

/// Executes the work according to the options: one task, all items, submission to a scheduler, or
/// collection of completed items. Returns the exit code. Throws the errors of batch::task_index()
/// and batch::submit().
int run_tasks(const TaskWork& work, const TaskOptions& options, const Console& console);

/// Returns the folder that contains the pieces of incomplete results.
std::filesystem::path shards_folder(const std::filesystem::path& results);
/// Returns the folder of one piece.
std::filesystem::path shard_folder(const std::filesystem::path& results, std::size_t number,
                                   std::size_t shards);

/// Interface for a result that is computed in pieces.
class ShardedJob {
 public:
  virtual ~ShardedJob() = default;

  /// Computes a piece unless it is already complete. Returns false if interrupted.
  virtual bool process_shard(std::size_t number) = 0;
  /// Returns whether a piece is complete, and stores its data for join().
  virtual bool load_shard(std::size_t number) = 0;
  /// Joins all pieces, which were passed to load_shard() in order, and commits the result. Returns
  /// the exit code.
  virtual int join(geometry::OutputFolder& folder) = 0;

 protected:
  ShardedJob() = default;
  ShardedJob(const ShardedJob&) = default;
  ShardedJob& operator=(const ShardedJob&) = default;
};

/// Executes a job whose items are pieces, as run_tasks(). The pieces are removed once the results
/// are complete. `summary` is the result file that indicates completeness; `begin` reads the
/// inputs.
int run_shards(const batch::JobRequest& job, const TaskOptions& options, bool is_quiet,
               const std::string& summary,
               const std::function<std::unique_ptr<ShardedJob>()>& begin, const Console& console);

}  // namespace skycap::missions::cli
