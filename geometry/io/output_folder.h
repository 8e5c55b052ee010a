/// Files that appear under their names only when all of them are whole.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::geometry {

/// Files are staged under temporary names beside their final ones, and renamed by commit(), so
/// that whoever finds a file finds all of it. What is not committed is removed again.
class OutputFolder {
 public:
  /// Makes the folder if need be. Throws Error{bad_file} if it cannot be written to.
  explicit OutputFolder(std::filesystem::path folder);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  const std::filesystem::path& path() const { return folder_; }

  /// Where to write the file that is to become `name`. Keeps its extension.
  std::filesystem::path stage(const std::string& name);
  /// Takes back stage(name).
  void drop(const std::string& name);
  /// Stages a file with that content. Throws Error{bad_file} if it cannot be written whole.
  void write(const std::string& name, std::string_view content);

  /// Has commit() remove files of an earlier run of which `is_old(name)` says that they belong to
  /// what is staged here, unless they are staged again.
  void replace(const std::function<bool(std::string_view)>& is_old);

  /// Gives the staged files their names, in the order in which they were staged.
  void commit();

 private:
  std::filesystem::path temporary(const std::string& name) const;

  std::filesystem::path folder_;
  std::vector<std::string> staged_;
  std::vector<std::string> old_;
  bool is_new_ = false;  ///< the folder was made here
};

}  // namespace skycap::geometry
