#include "missions/studio/upload.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "geometry/error.h"
#include "geometry/io/file.h"

namespace skycap::missions::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_uploads = 4;
constexpr std::chrono::seconds max_pause(60);                  ///< between two pieces
constexpr std::uintmax_t min_free = std::uintmax_t{64} << 20;  ///< left on the disk [byte]

/// Files of routes, and files that belong to maps and models.
constexpr std::array<std::string_view, 21> further_extensions{
    ".csv", ".kmz", ".plan", ".waypoints", ".gpx",  ".tum", ".srt",
    ".shx", ".dbf", ".prj",  ".cpg",       ".tfw",  ".mtl", ".bin",
    ".png", ".jpg", ".jpeg", ".json",      ".tiff", ".gz",  ".txt"};

std::string system_text() { return std::generic_category().message(errno); }

}  // namespace

void check_upload_name(const std::string& name) {
  const fs::path file(name);
  const std::string extension = geometry::lower_extension(file);
  if (name.empty() || name.size() > 200 || name.find('/') != std::string::npos ||
      name.find('\\') != std::string::npos || name.starts_with('.')) {
    throw Error(ErrorKind::bad_usage,
                "'" + name.substr(0, 200) + "' is not a permitted file name; rename the file");
  }
  if (find_kind(file).empty() &&
      std::ranges::find(further_extensions, extension) == further_extensions.end()) {
    throw Error(ErrorKind::bad_usage,
                name +
                    ": is not a map, model, cloud, mission or route; copy other files into the "
                    "folder");
  }
}

UploadList::~UploadList() {
  while (!uploads_.empty()) remove(uploads_.begin());
}

fs::path UploadList::temporary_name(const std::string& name) const {
  return folder_ / ("." + name + ".upload");
}

void UploadList::remove(std::vector<Upload>::iterator upload) {
  std::error_code ignored;
  fs::remove(upload->temporary, ignored);
  ::close(upload->handle);
  uploads_.erase(upload);
}

void UploadList::remove_idle() {
  const auto now = std::chrono::steady_clock::now();
  for (std::size_t i = uploads_.size(); i-- > 0;) {
    if (now - uploads_[i].last_use > max_pause)
      remove(uploads_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

UploadList::Upload& UploadList::find(int id) {
  const auto found = std::ranges::find(uploads_, id, &Upload::id);
  if (found == uploads_.end()) {
    throw Error(ErrorKind::bad_usage,
                "the upload has ended or paused too long; send the file again");
  }
  found->last_use = std::chrono::steady_clock::now();
  return *found;
}

int UploadList::begin(const WorkFolder& folder, const std::string& name, std::uintmax_t bytes,
                      bool replaces) {
  check_upload_name(name);
  const fs::path file = folder.resolve(name);
  if (bytes > max_bytes) {
    throw Error(ErrorKind::bad_usage,
                name + ": has more than 4 GiB; copy the file into the folder");
  }
  std::error_code failure;
  const fs::space_info space = fs::space(folder_, failure);
  if (!failure && space.available < bytes + min_free) {
    throw Error(ErrorKind::bad_file, name + ": not enough space on the disk; delete other files");
  }
  const std::scoped_lock lock(mutex_);
  remove_idle();
  if (fs::is_directory(file)) {
    throw Error(ErrorKind::bad_usage, name + ": is a folder; rename the file");
  }
  if (!replaces && fs::exists(file)) throw UploadConflict{name};
  if (uploads_.size() >= max_uploads) {
    throw Error(ErrorKind::bad_usage, "four files are being sent; wait for one to finish");
  }
  Upload upload{.id = last_id_ + 1,
                .name = name,
                .temporary = temporary_name(name),
                .bytes = bytes,
                .replaces = replaces,
                .last_use = std::chrono::steady_clock::now()};
  // The name is fixed, so that the rest of a killed upload is overwritten by the next one.
  upload.handle =
      ::open(upload.temporary.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (upload.handle < 0)
    throw Error(ErrorKind::bad_file, name + ": cannot write (" + system_text() + ")");
  if (::flock(upload.handle, LOCK_EX | LOCK_NB) != 0 || ::ftruncate(upload.handle, 0) != 0) {
    ::close(upload.handle);
    throw Error(ErrorKind::bad_usage, name + ": is already being sent by another page");
  }
  uploads_.push_back(upload);
  return ++last_id_;
}

void UploadList::add(int id, std::uintmax_t offset, std::string_view piece) {
  const std::scoped_lock lock(mutex_);
  Upload& upload = find(id);
  if (offset != upload.received || piece.size() > upload.bytes - upload.received) {
    throw Error(ErrorKind::bad_usage,
                upload.name + ": the piece does not follow the previous one; send the file again");
  }
  while (!piece.empty()) {
    const ssize_t count = ::write(upload.handle, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0)
      throw Error(ErrorKind::bad_file, upload.name + ": cannot write (" + system_text() + ")");
    piece.remove_prefix(static_cast<std::size_t>(count));
    upload.received += static_cast<std::uintmax_t>(count);
  }
}

std::string UploadList::end(int id) {
  const std::scoped_lock lock(mutex_);
  const Upload upload = find(id);
  if (upload.received != upload.bytes) {
    throw Error(ErrorKind::bad_usage, upload.name + ": " +
                                          std::to_string(upload.bytes - upload.received) +
                                          " bytes are missing; send the file again");
  }
  const fs::path file = folder_ / upload.name;
  if (::fsync(upload.handle) != 0)
    throw Error(ErrorKind::bad_file, upload.name + ": cannot write (" + system_text() + ")");
  const unsigned flags = upload.replaces ? 0 : RENAME_NOREPLACE;
  if (::renameat2(AT_FDCWD, upload.temporary.c_str(), AT_FDCWD, file.c_str(), flags) != 0) {
    const bool exists = errno == EEXIST;
    const std::string reason = system_text();
    remove(std::ranges::find(uploads_, id, &Upload::id));
    if (exists) throw UploadConflict{upload.name};
    throw Error(ErrorKind::bad_file, upload.name + ": cannot write (" + reason + ")");
  }
  ::close(upload.handle);
  std::erase_if(uploads_, [id](const Upload& each) { return each.id == id; });
  const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return upload.name;
}

void UploadList::cancel(int id) {
  const std::scoped_lock lock(mutex_);
  const auto found = std::ranges::find(uploads_, id, &Upload::id);
  if (found != uploads_.end()) remove(found);
}

}  // namespace skycap::missions::studio
