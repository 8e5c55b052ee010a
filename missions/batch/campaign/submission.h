/// Has an engine run a job.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "geometry/io/output_folder.h"
#include "missions/batch/campaign/engine_job.h"

namespace skycap::missions::batch {

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
