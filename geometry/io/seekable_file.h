/// A file of any size that is read from place to place, also one that gzip has compressed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "geometry/error.h"

namespace skycap::geometry {

class SeekableFile {
 public:
  /// Throws Error{bad_file} if it is no regular file, or cannot be opened.
  explicit SeekableFile(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }  ///< [bytes], when decompressed

  /// Bytes from a place, fewer if the file ends. Throws Error{bad_file}, whose sentence lacks the
  /// file's name: for decoders that know none, inside with_name().
  std::string bytes(std::uint64_t place, std::uint64_t count);

  /// What `read` gives; the file's name is put before the sentences of its errors.
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
  std::string decompressed_;  ///< all bytes, if gzip had compressed them
  std::uint64_t size_ = 0;
};

}  // namespace skycap::geometry
