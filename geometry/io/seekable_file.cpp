#include "geometry/io/seekable_file.h"

#include <algorithm>
#include <utility>

#include "geometry/io/file.h"

namespace skycap::geometry {

SeekableFile::SeekableFile(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code failure;
  size_ = std::filesystem::file_size(path_, failure);
  const bool is_file = std::filesystem::is_regular_file(path_, failure);
  if (is_file) stream_ = open_stream(path_);
  const auto beginning = [&] { return bytes(0, 2); };
  if (!is_file || !stream_ || with_name(beginning) == "\x1F\x8B") {
    decompressed_ =
        read_file(path_, std::size_t{512}
                             << 20);  // throws a specific Error if the path is not a regular file
    size_ = decompressed_.size();
  }
}

std::string SeekableFile::bytes(std::uint64_t offset, std::uint64_t count) {
  if (offset >= size_) return {};
  count = std::min(count, size_ - offset);
  if (!decompressed_.empty()) return decompressed_.substr(offset, count);
  std::string result(count, '\0');
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(offset));
  stream_.read(result.data(), std::ssize(result));
  if (!stream_) {
    throw Error(ErrorKind::bad_file, "cannot be read at byte " + std::to_string(offset));
  }
  return result;
}

}  // namespace skycap::geometry
