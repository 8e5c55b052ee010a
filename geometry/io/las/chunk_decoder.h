/// Decoders of the points of a chunk, one for each kind of compression.
#pragma once

#include <memory>

#include "geometry/io/las/byte_window.h"

namespace skycap::geometry::las {

/// Decodes a chunk. Its points must be decoded in order, independently of other chunks.
class ChunkDecoder {
 public:
  virtual ~ChunkDecoder() = default;

  /// Starts decoding `chunk` and writes its first point to `point` in the uncompressed format.
  /// Throws Error{bad_file}.
  virtual void begin(ByteWindow chunk, char* point) = 0;

  /// Writes the next point of the chunk to `point`. The chunk must have one. Throws
  /// Error{bad_file}.
  virtual void next(char* point) = 0;
};

/// Creates a decoder of all fields of the point formats 0 to 3.
std::unique_ptr<ChunkDecoder> make_pointwise_decoder(int format, std::size_t point_size);

/// Creates a decoder of the point formats 6 to 8 with item version 3 or 4. Unless `decodes_all`, it
/// decodes only position, return numbers, class, flags, channel and colour (not infrared). Other
/// bytes of a point are then not modified.
std::unique_ptr<ChunkDecoder> make_layered_decoder(int format, int version, std::size_t point_size,
                                                   bool decodes_all);

}  // namespace skycap::geometry::las
