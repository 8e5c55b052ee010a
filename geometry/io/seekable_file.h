/// File of any size with random read access. The file may be gzip-compressed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "geometry/error.h"

namespace skycap::geometry {

class SeekableFile {
 public:
  /// Throws Error{bad_file} if the file is not a regular file or cannot be opened.
  explicit SeekableFile(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }  ///< decompressed size [bytes]

  /// Returns `count` bytes from offset `offset`, or fewer at the end of the file. Throws
  /// Error{bad_file} without the file name in the message, for decoders called inside with_name().
  std::string bytes(std::uint64_t offset, std::uint64_t count);

  /// Returns the result of `read`. Prepends the file name to the message of any Error.
  template <typename Read>
  auto with_name(const Read& read) const {
    try {
      return read();
    } catch (const Error& error) {
      throw Error(ErrorKind::bad_file, path_.string() + ": " + error.what());
    }
  }

 private:
  std::filesystem::path path_;
  std::ifstream stream_;
  std::string decompressed_;  ///< content of a gzip-compressed file
  std::uint64_t size_ = 0;
};

}  // namespace skycap::geometry
