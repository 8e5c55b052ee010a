/// The bytes of a rawlog for MRPT. For the module.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include <zlib.h>

namespace skycap::missions::online {

/// A file, compressed by gzip or not. Unlike MRPT's own stream it tells damage from the end.
class RawlogBytes {
 public:
  /// Throws Error{bad_file}.
  explicit RawlogBytes(const std::filesystem::path& file);
  RawlogBytes(const RawlogBytes&) = delete;
  RawlogBytes& operator=(const RawlogBytes&) = delete;
  ~RawlogBytes();

  /// So many bytes, or as many as there are.
  std::size_t read(void* buffer, std::size_t count);

  std::uint64_t position() const { return position_; }

  /// What is wrong with the compressed file, if it is; complete once the end is reached.
  std::string damage() const;

 private:
  gzFile file_;
  std::uint64_t position_ = 0;
};

}  // namespace skycap::missions::online
