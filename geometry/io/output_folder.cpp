#include "geometry/io/output_folder.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "geometry/error.h"
#include "geometry/io/file.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view journal_name = ".commit", part_prefix = ".part-", old_prefix = ".old-";
constexpr std::size_t largest_journal = std::size_t{64} << 20;

[[noreturn]] void fail_at(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::bad_file, path.string() + ": " + what);
}

/// One name changed by a commit.
struct Change {
  std::string part;  ///< file to be renamed; empty: the file `name` is removed
  std::string name;
};

fs::path old_path(const fs::path& folder, const std::string& name) {
  return folder / (std::string(old_prefix) + name);
}

void require_renamed(const fs::path& from, const fs::path& to) {
  std::error_code failure;
  fs::rename(from, to, failure);
  if (failure) fail_at(to, "cannot be renamed to its final name (" + failure.message() + ")");
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::symlink_status(path, ignored).type() != fs::file_type::not_found;
}

/// Returns whether the name is a valid file name without folders.
bool is_plain(std::string_view name) {
  return !name.empty() && name.find('/') == std::string_view::npos && name != "." && name != "..";
}

std::string format_journal(const std::vector<Change>& changes) {
  std::string text;  // Each name ends with NUL, the only character that names cannot contain
  for (const Change& change : changes) text += change.part + '\0' + change.name + '\0';
  return text;
}

/// Parses a journal. Names that a commit cannot have written are ignored.
std::vector<Change> parse_changes(std::string_view text) {
  std::vector<Change> changes;
  const auto next = [&] {
    const std::string_view name = text.substr(0, text.find('\0'));
    text.remove_prefix(std::min(text.size(), name.size() + 1));
    return std::string(name);
  };
  while (!text.empty()) {
    Change change{next(), next()};
    const bool is_ours =
        change.part.empty() || (is_plain(change.part) && change.part.starts_with(part_prefix));
    if (is_ours && is_plain(change.name)) changes.push_back(std::move(change));
  }
  return changes;
}

/// Moves all old files away, starting with the file staged last, then renames all new files. A
/// reader who finds the file staged last thus finds all files of its run. Can be repeated after an
/// interruption.
void carry_out(const fs::path& folder, const std::vector<Change>& changes) {
  for (auto change = changes.rbegin(); change != changes.rend(); ++change) {
    const auto& [part, name] = *change;
    const bool is_next = part.empty() || is_there(folder / part);
    if (is_next && is_there(folder / name)) require_renamed(folder / name, old_path(folder, name));
  }
  for (const auto& [part, name] : changes) {
    if (!part.empty() && is_there(folder / part)) require_renamed(folder / part, folder / name);
  }
}

/// Restores the state before carry_out(). Returns false if that fails.
bool undo(const fs::path& folder, const std::vector<Change>& changes) {
  bool is_undone = true;
  const auto move_back = [&](const fs::path& from, const fs::path& to) {
    std::error_code failure;
    fs::rename(from, to, failure);
    is_undone = is_undone && !failure;
  };
  for (const auto& [part, name] : changes) {
    if (!part.empty() && !is_there(folder / part)) move_back(folder / name, folder / part);
  }
  for (const auto& [part, name] : changes) {
    if (is_there(old_path(folder, name))) move_back(old_path(folder, name), folder / name);
  }
  return is_undone;
}

void remove_file(const fs::path& path) {
  std::error_code ignored;  // a remaining file is removed by the next program
  fs::remove(path, ignored);
}

void finish_journal(const fs::path& folder) {
  const fs::path journal = folder / journal_name;
  if (!is_there(journal)) return;
  carry_out(folder, parse_changes(read_file(journal, largest_journal)));
  sync_to_disk(folder);
  remove_file(journal);
}

/// Returns a file descriptor that holds the lock, or -1. On file systems without locks, the call
/// always succeeds.
int locked(const fs::path& folder) {
  const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) fail_at(folder, "cannot be opened; use a folder that you can write to");
  if (::flock(handle, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return handle;
  ::close(handle);
  return -1;
}

}  // namespace

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code failure;
  if (fs::exists(folder_, failure) && !fs::is_directory(folder_, failure)) {
    fail_at(folder_, "is a file, not a folder; specify a folder for the results");
  }
  is_new_ = fs::create_directories(folder_, failure);
  if (failure) {
    fail_at(folder_,
            "cannot be created (" + failure.message() + "); use a folder that you can write to");
  }
  lock_and_clean();
}

void OutputFolder::lock_and_clean() {
  lock_ = locked(folder_);
  if (lock_ < 0) {
    fail_at(folder_,
            "is in use by another skycap process; wait for it to finish or use another folder");
  }
  try {
    finish_journal(folder_);
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored)) {
      const std::string name = entry.path().filename().string();
      const bool is_part = name.starts_with(part_prefix), is_old = name.starts_with(old_prefix);
      if (is_part) fs::remove_all(entry.path(), ignored);  // may be a folder for temporary files
      if (is_old && !entry.is_directory(ignored)) remove_file(entry.path());
    }
    // Detects an unwritable folder before the survey instead of after it.
    const fs::path probe = temporary("probe");
    write_file(probe, "\n");
    remove_file(probe);
  } catch (const Error& error) {
    ::close(lock_);
    throw Error(error.kind(), folder_.string() + ": cannot be written to (" + error.what() +
                                  "); use a folder that you can write to");
  }
}

OutputFolder::~OutputFolder() {
  // The files of an unfinished commit are kept for the next program to complete it.
  if (!is_there(folder_ / journal_name)) {
    for (const Staged& file : staged_) remove_file(temporary(file.name));
  }
  if (is_new_) remove_file(folder_);  // has no effect if the folder contains files
  ::close(lock_);
}

fs::path OutputFolder::temporary(const std::string& name) const {
  return folder_ / (std::string(part_prefix) + std::to_string(::getpid()) + "-" + name);
}

fs::path OutputFolder::stage(const std::string& name) {
  staged_.push_back({name, false});
  return temporary(name);
}

fs::path OutputFolder::stage_on_disk(const std::string& name) {
  staged_.push_back({name, true});
  return temporary(name);
}

bool OutputFolder::is_staged(const std::string& name) const {
  return std::ranges::find(staged_, name, &Staged::name) != staged_.end();
}

fs::path OutputFolder::staged(const std::string& name) const {
  return is_staged(name) ? temporary(name) : fs::path();
}

void OutputFolder::drop(const std::string& name) {
  remove_file(temporary(name));
  std::erase_if(staged_, [&](const Staged& file) { return file.name == name; });
}

void OutputFolder::write(const std::string& name, std::string_view content) {
  write_file(stage(name), content);
}

void OutputFolder::replace(const std::function<bool(std::string_view)>& is_old) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored)) {
    const std::string name = entry.path().filename().string();
    if (is_old(name)) old_.push_back(name);
  }
}

void OutputFolder::move_to(const std::string& subfolder) {
  OutputFolder target(folder_ / subfolder);
  for (const Staged& file : staged_) {
    require_renamed(temporary(file.name), target.temporary(file.name));
  }
  target.staged_ = std::exchange(staged_, {});
  std::swap(folder_, target.folder_);
  std::swap(staged_, target.staged_);
  std::swap(lock_, target.lock_);
  std::swap(is_new_, target.is_new_);
  old_.clear();
}

void OutputFolder::commit() {
  std::vector<Change> changes;
  for (const std::string& name : old_) {
    if (!is_staged(name)) changes.push_back({"", name});
  }
  for (const auto& [name, is_on_disk] : staged_) {
    if (!is_on_disk) sync_to_disk(temporary(name));
    if (fs::is_directory(fs::symlink_status(folder_ / name))) {
      fail_at(folder_ / name, "is a folder, but a result file requires this name; move the folder");
    }
    changes.push_back({temporary(name).filename().string(), name});
  }
  const fs::path journal = folder_ / journal_name;
  write_file(journal, format_journal(changes));
  try {
    sync_to_disk(folder_);  // syncs the journal's name before any file is moved
    carry_out(folder_, changes);
    sync_to_disk(folder_);
  } catch (const Error&) {
    if (undo(folder_, changes)) remove_file(journal);
    throw;
  }
  remove_file(journal);
  for (const Change& change : changes) remove_file(old_path(folder_, change.name));
  old_.clear();
  staged_.clear();
  is_new_ = false;
}

void finish_commit(const fs::path& folder) {
  if (!is_there(folder / journal_name)) return;
  const int lock = locked(folder);
  if (lock < 0) return;
  try {
    finish_journal(folder);
  } catch (const Error&) {
    ::close(lock);
    throw;
  }
  ::close(lock);
}

}  // namespace skycap::geometry
