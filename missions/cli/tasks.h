/// Work in numbered items: all of it here, or as the tasks of an engine for many jobs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "geometry/io/output_folder.h"
#include "missions/batch/campaign/task_job.h"
#include "missions/cli/verbs.h"

namespace skycap::missions::cli {

/// "; missing 3, 7, ...", of the first twenty; nothing of none.
std::string missing_text(const std::vector<std::size_t>& missing);

struct TaskWork {
  batch::JobRequest job;  ///< its command begins with the verb; its chunk follows from the options
  bool is_quiet = false;
  std::function<void(geometry::OutputFolder&)> submitting{};  ///< stages what else a job leaves
  /// Does items that are not complete, until a stop is requested; returns how many are complete.
  std::function<std::size_t(const batch::ItemRange&)> work{};
  /// Says whether the results are complete, and the items gone.
  std::function<bool()> is_collected{};
  /// Makes and commits the results of what is complete; returns the exit code.
  std::function<int(geometry::OutputFolder&)> collect{};
};

/// Does of the work what the options say: a task, all of it, a job for an engine, or the results of
/// what is complete. Returns the exit code. Throws what batch::task_index() and batch::submit()
/// throw.
int run_tasks(const TaskWork& work, const TaskOptions& options, const Console& console);

/// Where all pieces of results are kept while they are not complete.
std::filesystem::path folder_of_pieces(const std::filesystem::path& results);
/// Where one of so many is.
std::filesystem::path folder_of_piece(const std::filesystem::path& results, std::size_t number,
                                      std::size_t pieces);

/// A result that is made in pieces.
class PieceWork {
 public:
  virtual ~PieceWork() = default;

  /// Does a piece, unless it is complete among the results. False if it was interrupted.
  virtual bool do_piece(std::size_t number) = 0;
  /// Whether it is complete. Keeps what join() needs of it.
  virtual bool take_piece(std::size_t number) = 0;
  /// Makes and commits the results of all pieces, which were taken in their order; returns the exit
  /// code.
  virtual int join(geometry::OutputFolder& folder) = 0;

 protected:
  PieceWork() = default;
  PieceWork(const PieceWork&) = default;
  PieceWork& operator=(const PieceWork&) = default;
};

/// run_tasks() of a job whose items are pieces, which are removed when the results are there.
/// `summary` is the file that says in these whether they are complete; `begin` reads what the work
/// is about.
int run_pieces(const batch::JobRequest& job, const TaskOptions& options, bool is_quiet,
               const std::string& summary, const std::function<std::unique_ptr<PieceWork>()>& begin,
               const Console& console);

}  // namespace skycap::missions::cli
