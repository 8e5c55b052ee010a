/// Folder that the studio may read and write. Paths of requests are relative to it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace skycap::missions::studio {

/// File or results folder that the page lists.
struct ListedFile {
  std::string path;  ///< relative to the work folder
  std::string kind;  ///< mission, map, model, cloud, image, package or live
  std::uintmax_t bytes = 0;
};

struct Listing {
  std::vector<ListedFile> files;  ///< by path
  bool is_complete = true;        ///< false if files beyond a limit are not listed
};

/// Text of a file with its version, which changes with each change of the text.
struct VersionedText {
  std::string text, version;
};

class WorkFolder {
 public:
  /// Throws Error{bad_file} unless `folder` is a folder.
  explicit WorkFolder(const std::filesystem::path& folder);

  const std::filesystem::path& path() const { return folder_; }

  /// Returns the absolute path without symbolic links. Throws Error{bad_usage} if the path is
  /// absolute, contains "..", control characters or a hidden part, or leads out of the folder
  /// through a symbolic link. The last part need not exist.
  std::filesystem::path resolve(const std::string& relative) const;

  /// Lists files up to four levels deep, except hidden ones. Symbolic links to folders are not
  /// followed.
  Listing list() const;

  /// Lists the files of a results folder.
  std::vector<ListedFile> list_package(const std::string& package) const;

  /// Reads a file of at most 4 MiB. Throws Error{bad_file}.
  VersionedText read(const std::string& relative) const;

  /// Replaces a mission file atomically if it is still `version`; an empty version: if it does not
  /// exist. Returns the new version. Throws Error{bad_usage} if the name does not end in .yaml, and
  /// SaveConflict.
  std::string save(const std::string& relative, const std::string& text,
                   const std::string& version) const;

 private:
  std::filesystem::path folder_;
};

/// The file on disk is not the version that was edited. Nothing was written.
struct SaveConflict {
  VersionedText on_disk;  ///< current file; the version is empty if it does not exist
};

/// Returns the kind of a file by its name, or an empty string.
std::string find_kind(const std::filesystem::path& file);

}  // namespace skycap::missions::studio
