/// Encoder of chunks of the point formats 6 to 8 with item version 3, as LASzip 3 writes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace skycap::geometry::las {

/// Encodes chunks. They depend only on their own points, so that equal points give equal bytes.
class ChunkEncoder {
 public:
  virtual ~ChunkEncoder() = default;

  /// Adds a point of the format and size of the encoder. The number of points of a chunk must fit
  /// into 32 bits.
  virtual void add(const char* point) = 0;

  /// Returns the number of points of the chunk.
  virtual std::uint32_t points() const = 0;

  /// Returns the bytes of the chunk and begins a new one. The result is empty without points.
  virtual std::string finish() = 0;
};

/// `point_size` is at least the size of the format; bytes after that are coded one by one.
std::unique_ptr<ChunkEncoder> make_chunk_encoder(int format, std::size_t point_size);

/// Returns the number of layers of a point.
std::size_t layer_count(int format, std::size_t point_size);

}  // namespace skycap::geometry::las
