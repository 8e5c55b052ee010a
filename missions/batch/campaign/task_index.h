/// Which items a task of an engine runs.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace skycap::missions::batch {

/// Items [first, end) of a manifest.
struct ItemRange {
  std::size_t first = 0;
  std::size_t end = 0;

  std::size_t size() const { return end - first; }
};

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

}  // namespace skycap::missions::batch
