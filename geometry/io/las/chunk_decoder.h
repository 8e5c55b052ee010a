/// What turns the bytes of a chunk into points, for each kind of compression.
#pragma once

#include <memory>

#include "geometry/io/las/byte_window.h"

namespace skycap::geometry::las {

/// Points that were compressed together: without them all before it in its chunk, a point cannot be
/// decoded; without other chunks it can.
class ChunkDecoder {
 public:
  virtual ~ChunkDecoder() = default;

  /// Begins with a chunk, all bytes of which are `chunk`, and puts its first point at `point`, as
  /// the format has it without compression. Throws Error{bad_file}.
  virtual void begin(ByteWindow chunk, char* point) = 0;

  /// The next one; the chunk has to have one. Throws Error{bad_file}.
  virtual void next(char* point) = 0;
};

/// For points of format 0 to 3. All of each point is decoded.
std::unique_ptr<ChunkDecoder> make_pointwise_decoder(int format, std::size_t point_size);

/// For points of format 6 to 8: position, numbers of returns, class, flags, channel, colour (not
/// infrared); other bytes keep what they are. `version` of the items: 3 or 4.
std::unique_ptr<ChunkDecoder> make_layered_decoder(int format, int version, std::size_t point_size);

}  // namespace skycap::geometry::las
