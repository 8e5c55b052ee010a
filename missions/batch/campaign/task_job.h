/// Distributes numbered items of work, such as those of a campaign, to schedulers: Slurm, GNU
/// parallel and Open MPI.
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

/// Returns the value of an environment variable, or nullopt if it is not set.
using Environment = std::function<std::optional<std::string>(const std::string& name)>;

/// Returns an accessor of the process environment.
Environment program_environment();

/// Returns the task number, counted from 0. `index` is the number, or the name of a scheduler that
/// sets it in an environment variable:
/// - slurm: SLURM_ARRAY_TASK_ID, counted from 0;
/// - mpi: OMPI_COMM_WORLD_RANK, counted from 0;
/// - kubernetes: JOB_COMPLETION_INDEX, counted from 0;
/// - parallel: PARALLEL_SEQ, counted from 1;
/// - auto: the one of these variables that is set.
///
/// Throws Error{bad_usage} if the value is not a number or the variable is not set. With auto, also
/// throws it if several variables are set.
std::size_t task_index(const std::string& index, const Environment& environment);

/// Returns the items of a task with `chunk` items per task. The range is empty for tasks beyond the
/// last item.
ItemRange items_in_task(std::size_t task, std::size_t chunk, std::size_t items);

enum class EngineName { slurm, parallel, mpi };

/// Program name and arguments.
using Words = std::vector<std::string>;

/// Returns the scheduler with the given name: slurm, parallel or mpi.
EngineName engine_named(const std::string& name);

/// Inputs for the creation of a job.
struct JobRequest {
  /// Command with all options that affect the results, but without --quiet. --index, --chunk and
  /// --threads are added for tasks, and --collect for collecting the results. All paths are
  /// absolute.
  Words command;
  std::filesystem::path out;  ///< results folder
  std::string title;          ///< title in the scripts, such as "Campaign roofs"
  std::string name;           ///< job name
  std::size_t items = 0;
  std::size_t chunk = 0;  ///< items per task; zero: the scheduler's default
  unsigned jobs = 1;      ///< concurrent tasks, for schedulers without their own limit
};

/// Number of tasks and items per task.
struct TaskSplit {
  std::size_t tasks = 0;
  std::size_t chunk = 1;
};

/// Returns the division into tasks. If `chunk` is zero, Slurm uses at most 1000 tasks (its default
/// MaxArraySize), MPI one task per rank, and parallel one task per item.
TaskSplit split(EngineName engine, const JobRequest& request);

/// Returns a shell script that runs one command. Schedulers run it; users can run it to repeat the
/// job.
std::string job_script(const std::string& title, const std::vector<std::string>& directives,
                       const Words& command);

/// Files of a job and the command that starts it.
struct EngineJob {
  struct File {
    std::string name;
    std::string text;
  };
  std::vector<File> files;  ///< files for the results folder; tasks write messages to logs/
  Words command;
};

/// Creates the job for a scheduler. The Slurm command returns immediately and prints the job
/// number. The other commands return when all tasks have ended.
EngineJob engine_job(EngineName engine, const JobRequest& request);

struct Submission {
  bool is_queued = false;    ///< whether Slurm queues the tasks and the collection after them
  bool is_accepted = false;  ///< whether Slurm accepted both jobs
  std::string job;           ///< Slurm job number
  TaskSplit tasks;
};

/// Writes the job's scripts and the folder logs/ into `folder`, commits it and starts the job.
/// Slurm queues the job. For other schedulers, the function returns when all tasks have ended or
/// `stop` is requested. `warn` receives error messages of the scheduler. Throws Error{bad_usage} if
/// the scheduler is not installed.
Submission submit(EngineName engine, const JobRequest& request, geometry::OutputFolder& folder,
                  const std::stop_token& stop, const std::function<void(const std::string&)>& warn);

}  // namespace skycap::missions::batch
