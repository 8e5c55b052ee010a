/// Restricted access to files with GDAL, for the sources of its module. Excluded are drivers that
/// follow references to other files or hosts, and companion files with other names. Files are never
/// written next to the input: if a driver would write there, it reads a copy instead.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

class GDALDataset;
class OGRSpatialReference;

namespace skycap::missions::site_data {

/// Temporary folder for copies, removed by the destructor. Created by make().
class CopyFolder {
 public:
  CopyFolder() = default;
  CopyFolder(const CopyFolder&) = delete;
  CopyFolder& operator=(const CopyFolder&) = delete;
  ~CopyFolder();

  /// Creates the folder in the system's temporary folder. Throws Error{bad_file} naming `file`.
  void make(const std::filesystem::path& file);
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Open dataset, read from the file or from a copy of it.
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
  /// Returns notes for the user about the steps taken to read the file.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::filesystem::path readable(const std::filesystem::path& file);

  CopyFolder copy_;  ///< Copy of the file; must outlive the dataset.
  GDALDataset* dataset_ = nullptr;
  std::vector<std::string> notes_;
  bool is_immutable_ = false;  ///< The SQLite database has no log and is opened as immutable.
};

/// Returns GDAL's last error message as one line.
std::string last_gdal_error();

/// Returns the reference system as WKT for PROJ; empty without a system.
std::string to_wkt(const OGRSpatialReference* system);

}  // namespace skycap::missions::site_data
