/// Numbered items of work, such as those of a campaign, as a job of an engine that others have
/// written: Slurm, GNU parallel, OpenMPI; and which items a task of it runs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/batch/campaign/campaign_file.h"

namespace skycap::missions::batch {

/// The value of a variable of the environment; nothing if it is not set.
using Environment = std::function<std::optional<std::string>(const std::string& name)>;

/// The program's own.
Environment program_environment();

/// The number of a task, from 0 on. `index` says it, or names the engine whose variable does:
///
/// | index        | variable             | counts from |
/// | slurm        | SLURM_ARRAY_TASK_ID  | 0           |
/// | mpi          | OMPI_COMM_WORLD_RANK | 0           |
/// | kubernetes   | JOB_COMPLETION_INDEX | 0           |
/// | parallel     | PARALLEL_SEQ         | 1           |
/// | auto         | the one that is set  |             |
///
/// Throws Error{bad_usage} if it is no number, or if the variable is not set; auto, if several are.
std::size_t task_index(const std::string& index, const Environment& environment);

/// The items of a task when each has `chunk`: empty for tasks beyond the last item.
ItemRange items_of_task(std::size_t task, std::size_t chunk, std::size_t items);

enum class EngineName { slurm, parallel, mpi };

/// A program and its arguments.
using Words = std::vector<std::string>;

/// The engine of that name, one of slurm, parallel and mpi.
EngineName engine_named(const std::string& name);

/// What a job is made from.
struct JobRequest {
  /// The verb with all that decides the results, without --quiet: --index, --chunk and --threads
  /// make a task of it, --collect the work behind all tasks. All paths are absolute.
  Words command;
  std::filesystem::path out;  ///< where the results go
  std::string title;          ///< of its scripts, such as "Campaign roofs"
  std::string name;           ///< of the job
  std::size_t items = 0;
  std::size_t chunk = 0;  ///< items of a task; zero: as the engine likes it
  unsigned jobs = 1;      ///< tasks at a time, of engines that have no limit of their own
};

/// How many tasks there are, and of how many items.
struct TaskSplit {
  std::size_t tasks = 0;
  std::size_t chunk = 1;
};

/// Without a chunk: for Slurm at most 1000 tasks, which its default MaxArraySize allows; for MPI
/// one for each rank; for parallel one for each item.
TaskSplit split(EngineName engine, const JobRequest& request);

/// A shell script of one command, for engines that take scripts and for people who start it again.
std::string job_script(const std::string& title, const std::vector<std::string>& directives,
                       const Words& command);

/// The files of a job, and how it is started.
struct EngineJob {
  struct File {
    std::string name;
    std::string text;
  };
  std::vector<File> files;  ///< for the folder of results; tasks write their messages to logs/
  Words command;
};

/// Slurm's returns at once and prints the job's number; the others last until all tasks have ended.
EngineJob engine_job(EngineName engine, const JobRequest& request);

struct Submission {
  bool is_queued = false;    ///< by Slurm: what is collected is queued behind it
  bool is_accepted = false;  ///< by Slurm, both of them
  std::string job;           ///< its number in Slurm
  TaskSplit tasks;
};

/// Writes the job's scripts into `folder`, where logs/ is made for messages of tasks, commits them
/// and starts the job. Slurm queues it; of other engines all tasks have ended then, or `stop` was
/// requested. `warn` is told how an engine failed. Throws Error{bad_usage} if it is not installed.
Submission submit(EngineName engine, const JobRequest& request, geometry::OutputFolder& folder,
                  const std::stop_token& stop, const std::function<void(const std::string&)>& warn);

}  // namespace skycap::missions::batch
