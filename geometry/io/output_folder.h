/// Atomic creation of several files in a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::geometry {

/// Stages files under temporary names in the folder. commit() renames either all of them or none.
/// Uncommitted files are removed by the destructor, or after a kill by the next program that opens
/// the folder.
///
/// A commit syncs the files to disk, writes a journal of its steps, moves replaced files to
/// temporary names, and renames the new files. An error undoes the commit. After a kill or a power
/// failure, the next program that opens the folder or calls finish_commit() completes the commit
/// from the journal.
class OutputFolder {
 public:
  /// Opens and locks the folder for writing. Creates it if it does not exist and completes an
  /// interrupted commit. Throws Error{bad_file} if the folder is not writable or is locked by
  /// another program or object.
  explicit OutputFolder(std::filesystem::path folder);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  const std::filesystem::path& path() const { return folder_; }

  /// Returns the path to which the file with the final name `name` must be written. It has the same
  /// extension.
  std::filesystem::path stage(const std::string& name);
  /// Returns the path for a file that the caller syncs to disk before commit(). This avoids waiting
  /// in commit() for thousands of files.
  std::filesystem::path stage_on_disk(const std::string& name);
  /// Returns the path returned by stage(name), or an empty path if `name` is not staged.
  std::filesystem::path staged(const std::string& name) const;
  /// Removes `name` from the staged files.
  void drop(const std::string& name);
  /// Stages a file with this content. Throws Error{bad_file} if it cannot be written completely.
  void write(const std::string& name, std::string_view content);

  /// Selects files of an earlier run that commit() removes: those for which `is_old(name)` is true
  /// and that are not staged again.
  void replace(const std::function<bool(std::string_view)>& is_old);

  /// Sets the subfolder into which commit() moves the files. Cancels replace().
  void move_to(const std::string& subfolder);

  /// Renames the staged files to their final names. If it throws Error{bad_file}, the folder is
  /// unchanged.
  void commit();

 private:
  struct Staged {
    std::string name;
    bool is_on_disk;
  };

  std::filesystem::path temporary(const std::string& name) const;
  void lock_and_clean();
  bool is_staged(const std::string& name) const;

  std::filesystem::path folder_;
  std::vector<Staged> staged_;
  std::vector<std::string> old_;
  int lock_ = -1;        ///< file descriptor of the folder, which holds the lock
  bool is_new_ = false;  ///< true if the constructor created the folder
};

/// Completes a commit that a kill or a power failure has interrupted. To be called before reading
/// the folder. Does nothing while another program is writing to the folder. Throws Error{bad_file}.
void finish_commit(const std::filesystem::path& folder);

}  // namespace skycap::geometry
