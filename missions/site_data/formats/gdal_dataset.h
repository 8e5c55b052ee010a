/// How this program opens files with GDAL, for the sources of its module: no driver that follows
/// names to other files or hosts, no files of others beside the one that is named, and nothing is
/// written beside it: what a driver would write to is read from a copy.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

class GDALDataset;
class OGRSpatialReference;

namespace skycap::missions::site_data {

/// A folder for copies, removed with all that is in it. Without a path there is none.
class CopyFolder {
 public:
  CopyFolder() = default;
  CopyFolder(const CopyFolder&) = delete;
  CopyFolder& operator=(const CopyFolder&) = delete;
  ~CopyFolder();

  /// Makes the folder, in that for temporary files. Throws Error{bad_file} that names the file.
  void make(const std::filesystem::path& file);
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A file that is open, and the copy that it may be read from.
class OpenDataset {
 public:
  /// Opens a file for reading with one of the drivers. Throws Error{bad_file} with GDAL's reason.
  OpenDataset(const std::filesystem::path& file, unsigned kind,
              const std::vector<const char*>& drivers);
  OpenDataset(const OpenDataset&) = delete;
  OpenDataset& operator=(const OpenDataset&) = delete;
  ~OpenDataset();

  GDALDataset& operator*() const { return *dataset_; }
  GDALDataset* operator->() const { return dataset_; }
  /// What was done to read it, for the user.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::filesystem::path readable(const std::filesystem::path& file);

  CopyFolder copy_;  ///< outlives the dataset
  GDALDataset* dataset_ = nullptr;
  std::vector<std::string> notes_;
  bool is_immutable_ = false;  ///< a database that nobody writes to while it is read
};

/// What GDAL last complained of, in one line.
std::string gdal_complaint();

/// As WKT that PROJ reads; empty if there is none.
std::string wkt_of(const OGRSpatialReference* system);

}  // namespace skycap::missions::site_data
