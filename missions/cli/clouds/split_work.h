/// Work that is done in pieces, here or as the tasks of an engine, and what is made of them. For
/// the sources of this room.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "geometry/io/output_folder.h"
#include "missions/batch/campaign/engine_job.h"
#include "missions/cli/verbs.h"

namespace skycap::missions::cli {

/// Where all pieces of results are kept while they are not complete.
std::filesystem::path folder_of_pieces(const std::filesystem::path& results);
/// Where one of so many is.
std::filesystem::path folder_of_piece(const std::filesystem::path& results, std::size_t number,
                                      std::size_t pieces);

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

struct SplitWork {
  std::size_t pieces = 0;
  std::filesystem::path out;  ///< the folder of the results
  std::string summary;        ///< the file that says in it whether they are complete
  std::string title;          ///< such as "Scan roofs"
  std::string name;           ///< of a job
  batch::Words command{};     ///< the verb and what decides the results; absolute paths
  unsigned jobs = 1;          ///< at a time
  bool is_quiet = false;
  std::function<std::unique_ptr<PieceWork>()> begin{};  ///< reads what the work is about
};

/// Does of the work what the options say: a task, all of it, or the results of what is complete.
/// The pieces are removed when the results are there. Returns the exit code.
int run_split(const SplitWork& work, const TaskOptions& task, const Console& console);

}  // namespace skycap::missions::cli
