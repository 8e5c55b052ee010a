/// Files that appear under their names only when all of them are whole.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::geometry {

/// Files are staged under temporary names beside their final ones; commit() gives all of them
/// their names, or none. What is not committed is removed again, if the program is killed by the
/// next one that opens the folder.
///
/// A commit brings the files to the disk, writes down what it will do (a journal), moves what it
/// replaces aside, and renames. A failure on the way is undone. After a kill or a power cut the
/// journal stands, and the next program that opens or finishes the folder completes the commit.
class OutputFolder {
 public:
  /// Makes the folder if need be, finishes what a killed program left there, and keeps other
  /// writers out. Throws Error{bad_file} if the folder cannot be written to or another program
  /// (or object) is at it.
  explicit OutputFolder(std::filesystem::path folder);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  const std::filesystem::path& path() const { return folder_; }

  /// Where to write the file that is to become `name`. Keeps its extension.
  std::filesystem::path stage(const std::string& name);
  /// The same of a file whose bytes are on the disk before commit(), which then need not wait for
  /// it: for thousands of files.
  std::filesystem::path stage_on_disk(const std::string& name);
  /// Where stage(name) has put the file; an empty path if nothing is staged under that name.
  std::filesystem::path staged(const std::string& name) const;
  /// Takes back stage(name).
  void drop(const std::string& name);
  /// Stages a file with that content. Throws Error{bad_file} if it cannot be written whole.
  void write(const std::string& name, std::string_view content);

  /// Has commit() remove files of an earlier run of which `is_old(name)` says that they belong to
  /// what is staged here, unless they are staged again.
  void replace(const std::function<bool(std::string_view)>& is_old);

  /// Has commit() put the files into a folder within this one. What replace() was told is void.
  void move_to(const std::string& subfolder);

  /// Gives the staged files their names. Throws Error{bad_file}: then the folder is as it was.
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
  int lock_ = -1;        ///< a handle of the folder; others cannot lock it while it is open
  bool is_new_ = false;  ///< the folder was made here
};

/// Completes a commit that a kill or a power cut has interrupted, for whoever is about to read the
/// folder. Does nothing while a program is writing there. Throws Error{bad_file}.
void finish_commit(const std::filesystem::path& folder);

}  // namespace skycap::geometry
