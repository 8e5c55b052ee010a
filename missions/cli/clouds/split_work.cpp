#include "missions/cli/clouds/split_work.h"

#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "missions/cli/tasks.h"
#include "missions/package/package.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

int do_pieces(const batch::ItemRange& range, PieceWork& work, const Console& console) {
  for (std::size_t number = range.first; number < range.end; ++number) {
    if (!work.do_piece(number)) return interrupted_exit_code(console);
  }
  return 0;
}

/// Whether what is to be collected has been.
bool is_collected(const SplitWork& split) {
  std::error_code ignored;
  return !fs::exists(folder_of_pieces(split.out), ignored) &&
         package::is_complete_result(split.out / split.summary);
}

int collect(const SplitWork& split, PieceWork& work, geometry::OutputFolder& folder,
            const Console& console) {
  std::vector<std::size_t> missing;
  std::error_code ignored;
  for (std::size_t number = 0; number < split.pieces; ++number) {
    const fs::path piece = folder_of_piece(split.out, number, split.pieces);
    if (fs::exists(piece, ignored)) geometry::finish_commit(piece);
    if (!work.take_piece(number)) missing.push_back(number);
  }
  if (!missing.empty()) {
    warn(console, fmt::format("{} of {} pieces are complete{}", split.pieces - missing.size(),
                              split.pieces, missing_text(missing)));
    return 1;
  }
  const int exit_code = work.join(folder);
  if (exit_code == 0) fs::remove_all(folder_of_pieces(split.out), ignored);
  return exit_code;
}

}  // namespace

fs::path folder_of_pieces(const fs::path& results) { return results / "pieces"; }

fs::path folder_of_piece(const fs::path& results, std::size_t number, std::size_t pieces) {
  return folder_of_pieces(results) / fmt::format("{}_of_{}", number, pieces);
}

int run_split(const SplitWork& split, const TaskOptions& task, const Console& console) {
  if (task.engine) {
    geometry::OutputFolder folder(split.out);
    const batch::JobRequest job{.command = split.command,
                                .out = fs::absolute(split.out),
                                .title = split.title,
                                .name = split.name,
                                .items = split.pieces,
                                .jobs = split.jobs};
    return submit_job(task, job, folder, split.is_quiet, console,
                      [&] { return collect(split, *split.begin(), folder, console); });
  }
  if (task.index) {
    const batch::ItemRange range = items_of(task, split.pieces, console);
    return range.size() == 0 ? 0 : do_pieces(range, *split.begin(), console);
  }
  geometry::OutputFolder folder(split.out);
  if (task.collects && is_collected(split)) {
    warn(console, split.out.string() + ": contains no pieces; its results are complete");
    return 0;
  }
  const std::unique_ptr<PieceWork> work = split.begin();
  if (!task.collects) {
    const int exit_code = do_pieces({0, split.pieces}, *work, console);
    if (exit_code != 0) return exit_code;
  }
  return collect(split, *work, folder, console);
}

}  // namespace skycap::missions::cli
