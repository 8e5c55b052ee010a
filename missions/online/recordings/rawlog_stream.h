/// Byte stream of a rawlog, for the module only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include <zlib.h>

namespace skycap::missions::online {

/// File, optionally compressed by gzip. Unlike MRPT's own stream, it distinguishes damage from the
/// end of the file.
class RawlogBytes {
 public:
  /// Throws Error{bad_file} if the file cannot be opened.
  explicit RawlogBytes(const std::filesystem::path& file);
  RawlogBytes(const RawlogBytes&) = delete;
  RawlogBytes& operator=(const RawlogBytes&) = delete;
  ~RawlogBytes();

  /// Reads up to `count` bytes and returns their number. Fewer bytes are read at the end of the
  /// file.
  std::size_t read(void* buffer, std::size_t count);

  std::uint64_t position() const { return position_; }

  /// Returns the description of a compression error, or an empty string. Complete only after the
  /// end of the file was reached.
  std::string damage() const;

 private:
  gzFile file_;
  std::uint64_t position_ = 0;
};

}  // namespace skycap::missions::online
