/// Sequential reader of the points of a compressed LAS file (LAZ, COPC).
#pragma once

#include <memory>

#include "geometry/io/las/chunk_decoder.h"
#include "geometry/io/las/compression.h"

namespace skycap::geometry::las {

/// Header fields that describe the points of a file.
struct StoredPoints {
  int format = 0;        ///< 0 to 3 or 6 to 8
  std::size_t size = 0;  ///< uncompressed size of a point [bytes]; at least the size of the format
  std::uint64_t first = 0;   ///< file offset
  bool decodes_all = false;  ///< decode all fields of formats 6 to 8 (chunk_decoder.h)
};

class PointStream {
 public:
  /// `record` is the content of the compression record. The constructor and next() throw
  /// Error{bad_file} without the file name in the message.
  PointStream(ReadBytes read, std::uint64_t file_size, const StoredPoints& points,
              std::string_view record);
  PointStream(const PointStream&) = delete;
  PointStream& operator=(const PointStream&) = delete;

  /// Writes the next point to `point` in the uncompressed format. For formats 6 to 8, only the
  /// fields listed at make_layered_decoder() are written. Must not be called more often than there
  /// are points in the header. Throws Error{bad_file}.
  void next(char* point);

  /// Returns the number of points after the last one in its chunk.
  std::uint64_t left_in_chunk() const { return left_in_chunk_; }
  void skip_chunk() { left_in_chunk_ = 0; }  ///< Skips the rest of the chunk.

 private:
  ReadBytes read_;
  ChunkTable chunks_;
  std::unique_ptr<ChunkDecoder> decoder_;
  std::uint64_t left_in_chunk_ = 0;
};

}  // namespace skycap::geometry::las
