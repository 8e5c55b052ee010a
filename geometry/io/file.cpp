#include "geometry/io/file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <limits>
#include <new>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::bad_file, path.string() + ": " + what);
}

std::string last_error() { return std::generic_category().message(errno); }

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::string size_text(std::size_t bytes) {
  return bytes >= std::size_t{1} << 30 ? std::to_string(bytes >> 30) + " GiB"
                                       : std::to_string(bytes >> 20) + " MiB";
}

/// Returns the size of the last member, which the file's last four bytes state modulo 2^32
/// (RFC 1952), or 0.
std::size_t declared_size(std::string_view gzip) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < 4 && i < gzip.size(); ++i) {
    size = size << 8 | static_cast<std::uint8_t>(gzip[gzip.size() - 1 - i]);
  }
  return size;
}

std::string inflate_gzip(const fs::path& path, std::string_view bytes, std::size_t max_bytes) {
  z_stream stream{};
  constexpr int gzip_only = 16 + MAX_WBITS;
  const int start = inflateInit2(&stream, gzip_only);
  if (start == Z_MEM_ERROR) throw std::bad_alloc();
  if (start != Z_OK) fail(path, "zlib cannot start");
  std::string inflated, chunk(1 << 20, '\0');
  inflated.reserve(std::min(declared_size(bytes), max_bytes) + chunk.size());
  int status = Z_OK;
  while (status == Z_OK || (status == Z_STREAM_END && !bytes.empty())) {
    if (status == Z_STREAM_END) inflateReset(&stream);  // gzip files may be concatenated
    const auto chunk_size = std::min<std::size_t>(bytes.size(), std::numeric_limits<uInt>::max());
    // zlib does not modify its input, but its C interface is const only if ZLIB_CONST is defined.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(chunk_size);
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    status = inflate(&stream, Z_NO_FLUSH);
    bytes.remove_prefix(chunk_size - stream.avail_in);
    inflated.append(chunk, 0, chunk.size() - stream.avail_out);
    if (inflated.size() > max_bytes) break;
  }
  inflateEnd(&stream);
  if (status == Z_MEM_ERROR) throw std::bad_alloc();
  if (inflated.size() > max_bytes) {
    fail(path, "is larger than " + size_text(max_bytes) + " when decompressed");
  }
  if (status != Z_STREAM_END) {
    fail(path, "is not a complete gzip file (damaged or truncated); obtain it again");
  }
  return inflated;
}

/// Exclusively locked temporary file in the folder of the target.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target) {
    // Another writer may have locked the file, or renamed it between open() and flock().
    for (int number = 0; handle_ < 0; ++number) {
      path_ = target.parent_path() /
              (".part-" + std::to_string(number) + "-" + target.filename().string());
      handle_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
      if (handle_ < 0) fail(target, "cannot be written: " + last_error());
      const bool is_locked = ::flock(handle_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
      if (!is_locked && is_still_there()) break;
      ::close(std::exchange(handle_, -1));
    }
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!is_named_) ::unlink(path_.c_str());
    ::close(handle_);
  }

  /// Writes the bytes to disk and renames the file. Returns false and sets errno if that fails.
  bool put(std::string_view bytes, const fs::path& name) {
    if (::ftruncate(handle_, 0) != 0) return false;
    while (!bytes.empty()) {
      const ssize_t count = ::write(handle_, bytes.data(), bytes.size());
      if (count < 0 && errno != EINTR) return false;
      if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    if (::fsync(handle_) != 0) return false;
    is_named_ = ::rename(path_.c_str(), name.c_str()) == 0;
    return is_named_;
  }

 private:
  bool is_still_there() const {
    struct stat ours {
    }, named{};
    return ::fstat(handle_, &ours) == 0 && ::lstat(path_.c_str(), &named) == 0 &&
           ours.st_ino == named.st_ino && ours.st_dev == named.st_dev;
  }

  fs::path path_;
  int handle_ = -1;
  bool is_named_ = false;
};

}  // namespace

std::string lower_extension(fs::path path) {
  const auto lower = [](std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
  };
  if (lower(path.extension().string()) == ".gz") path = path.stem();
  return lower(path.extension().string());
}

void require_regular_file(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (error && status.type() == fs::file_type::none) {
    fail(path, "cannot be opened: " + error.message());
  }
  if (!fs::exists(status)) fail(path, "does not exist");
  if (fs::is_directory(status)) fail(path, "is a directory; expected a file");
  if (!fs::is_regular_file(status)) fail(path, "is a device or a pipe; expected a regular file");
}

std::ifstream open_stream(const fs::path& path) {
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream && errno == ENOMEM) throw std::bad_alloc();
  return stream;
}

std::string read_file(const fs::path& path, std::size_t max_bytes, std::size_t max_decompressed) {
  require_regular_file(path);
  std::ifstream stream = open_stream(path);
  if (!stream) fail(path, "cannot be opened: " + last_error());
  const auto reject_size = [&] { fail(path, "is larger than " + size_text(max_bytes)); };
  std::error_code error;
  const auto size = fs::file_size(path, error);
  if (!error && size > max_bytes) reject_size();
  std::string bytes;
  if (!error) bytes.reserve(size);
  constexpr std::uintmax_t largest_chunk = 1 << 20;
  std::string chunk(error ? largest_chunk : std::min(largest_chunk, size + 1), '\0');
  while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())),
         stream.gcount() > 0) {
    bytes.append(chunk, 0, static_cast<std::size_t>(stream.gcount()));
    if (bytes.size() > max_bytes) reject_size();
  }
  if (stream.bad()) fail(path, "cannot be read: " + last_error());
  if (!is_gzip(bytes)) return bytes;
  return inflate_gzip(path, bytes, std::min(max_bytes, max_decompressed));
}

void write_file(const fs::path& path, std::string_view bytes) {
  std::error_code unmade;  // a missing folder is reported when the file is opened
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), unmade);
  if (!TemporaryFile(path).put(bytes, path)) fail(path, "cannot be written: " + last_error());
}

void cut_file(const fs::path& path, std::uintmax_t bytes) {
  std::error_code failure;
  const std::uintmax_t size = fs::file_size(path, failure);
  if (!failure && size < bytes) {
    fail(path, "contains " + std::to_string(size) + " bytes, less than the " +
                   std::to_string(bytes) + " that were written");
  }
  if (!failure) fs::resize_file(path, bytes, failure);
  if (failure) fail(path, "cannot be truncated: " + failure.message());
}

void sync_to_disk(const fs::path& path) {
  const int handle = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  // Some file systems do not support syncing folders, and do not require it.
  const bool is_done = handle >= 0 && (::fsync(handle) == 0 || errno == EINVAL);
  const std::string reason = is_done ? "" : last_error();
  if (handle >= 0) ::close(handle);
  if (!is_done) fail(path, "cannot be flushed to the disk: " + reason);
}

}  // namespace skycap::geometry
