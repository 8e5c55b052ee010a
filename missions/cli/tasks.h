/// Work in numbered items, of which engines for many jobs may run some.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/batch/campaign/engine_job.h"
#include "missions/batch/campaign/task_index.h"
#include "missions/cli/verbs.h"

namespace skycap::missions::cli {

/// The items of the task of options.index; warns if it has none. Throws what
/// batch::task_index() throws.
batch::ItemRange items_of(const TaskOptions& options, std::size_t items, const Console& console);

/// "; missing 3, 7, ...", of the first twenty; nothing of none.
std::string missing_text(const std::vector<std::size_t>& missing);

/// Has options.engine run the job, whose command begins with the verb, with the scripts in
/// `folder`. Behind a job that is over, `collect` makes the results; behind a queued one, a job
/// does. Returns the exit code.
int submit_job(const TaskOptions& options, batch::JobRequest job, geometry::OutputFolder& folder,
               bool is_quiet, const Console& console, const std::function<int()>& collect);

}  // namespace skycap::missions::cli
