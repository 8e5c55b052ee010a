/// The points of a compressed LAS file (LAZ, COPC), one after another, chunk by chunk.
#pragma once

#include <memory>

#include "geometry/io/las/chunk_decoder.h"
#include "geometry/io/las/compression.h"

namespace skycap::geometry::las {

/// What the file's header says of its points.
struct StoredPoints {
  int format = 0;           ///< 0 to 3 or 6 to 8
  std::size_t size = 0;     ///< of one, not compressed [bytes]; at least the format's
  std::uint64_t first = 0;  ///< place in the file
};

class PointStream {
 public:
  /// `record` is the content of the file's record of its compression. Throws Error{bad_file}; the
  /// sentences, from here and from next(), lack the file's name.
  PointStream(ReadBytes read, std::uint64_t file_size, const StoredPoints& points,
              std::string_view record);
  PointStream(const PointStream&) = delete;
  PointStream& operator=(const PointStream&) = delete;

  /// The next point at `point`, as the format has it without compression; of formats 6 to 8, what
  /// make_layered_decoder() says. The header knows how often there is one. Throws Error{bad_file}.
  void next(char* point);

 private:
  ReadBytes read_;
  ChunkTable chunks_;
  std::unique_ptr<ChunkDecoder> decoder_;
  std::uint64_t left_in_chunk_ = 0;
};

}  // namespace skycap::geometry::las
