/// Files that the page sends into the work folder, in pieces of at most 4 MiB.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "missions/studio/work_folder.h"

namespace skycap::missions::studio {

/// A file of this name exists, and the request does not permit replacing it. Nothing was written.
struct UploadConflict {
  std::string name;
};

/// Unfinished uploads. Each is a hidden temporary file, which is renamed when it is complete, so
/// that no incomplete file has the final name. Safe to use from several threads.
class UploadList {
 public:
  static constexpr std::uintmax_t max_bytes = std::uintmax_t{4} << 30;  ///< of a file

  explicit UploadList(std::filesystem::path folder) : folder_(std::move(folder)) {}
  UploadList(const UploadList&) = delete;
  UploadList& operator=(const UploadList&) = delete;
  ~UploadList();  ///< removes the temporary files

  /// Starts an upload and returns its number. Throws Error{bad_usage} if check_upload_name()
  /// rejects the name, or if the size or the number of uploads is not permitted. Throws
  /// Error{bad_file} if there is not enough space, and UploadConflict if the file exists and
  /// `replaces` is false.
  int begin(const WorkFolder& folder, const std::string& name, std::uintmax_t bytes, bool replaces);

  /// Appends a piece. Throws Error{bad_usage} unless `offset` is the number of bytes so far and the
  /// piece fits in the announced size.
  void add(int id, std::uintmax_t offset, std::string_view piece);

  /// Publishes a complete file under its name and returns the name. Throws Error{bad_usage} if
  /// bytes are missing, and UploadConflict if the file has been created meanwhile.
  std::string end(int id);

  void cancel(int id);  ///< removes the temporary file; unknown numbers are ignored

 private:
  struct Upload {
    int id = 0;
    std::string name;
    std::filesystem::path temporary;
    std::uintmax_t bytes = 0, received = 0;
    bool replaces = false;
    int handle = -1;
    std::chrono::steady_clock::time_point last_use;
  };

  std::filesystem::path temporary_name(const std::string& name) const;
  Upload& find(int id);
  void remove(std::vector<Upload>::iterator upload);
  void remove_idle();

  std::mutex mutex_;
  std::filesystem::path folder_;
  std::vector<Upload> uploads_;
  int last_id_ = 0;
};

/// Throws Error{bad_usage} unless the name is a file name without a folder with a permitted ending:
/// that of a map, model, cloud, mission or route, or of a file that belongs to one of these.
/// Programs, modules and web pages are rejected.
void check_upload_name(const std::string& name);

}  // namespace skycap::missions::studio
