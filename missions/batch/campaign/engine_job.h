/// Numbered items of work, such as those of a campaign, as a job of an engine that others have
/// written: Slurm, GNU parallel, OpenMPI.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace skycap::missions::batch {

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

/// What queues the collecting behind a job of Slurm.
Words slurm_collection(const JobRequest& request, const std::string& job);

}  // namespace skycap::missions::batch
