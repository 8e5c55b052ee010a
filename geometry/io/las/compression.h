/// Compression record of a LAZ file (LAZ specification 1.4, section 3) and table of its chunks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "geometry/io/las/byte_window.h"
#include "geometry/io/las/integer_coder.h"

namespace skycap::geometry::las {

/// User ID and record ID of the compression record.
inline constexpr std::string_view compression_user = "laszip encoded";
inline constexpr std::uint16_t compression_id = 22204;

/// Chunk size in the record of files whose chunk sizes vary.
inline constexpr std::uint32_t various_chunk_sizes = 0xFFFFFFFF;

struct Compression {
  int version = 0;               ///< version of the items of a point
  std::uint32_t chunk_size = 0;  ///< points per chunk, except for the last one
  /// Returns whether chunk sizes vary. If they do, the chunk table contains the number of points.
  bool has_various_chunks() const { return chunk_size == various_chunk_sizes; }
};

/// Parses the content of the record. Throws Error{bad_file} if the compression is not supported.
/// Supported are chunked files whose items match the point format and size. Required item versions:
/// 2 for point formats 0 to 3; 3 or 4 for point formats 6 to 8.
Compression parse_compression(std::string_view record, int format, std::size_t point_size);

/// Returns the content of the record for layered chunks of a point format from 6 to 8.
std::string write_compression(const Compression& compression, int format, std::size_t point_size);

/// Reads the chunk table entry by entry, so that an invalid number of chunks cannot exhaust the
/// memory.
class ChunkTable {
 public:
  struct Chunk {
    std::uint64_t begin = 0, end = 0;  ///< byte range in the file
    std::uint64_t points = 0;
  };

  /// `first_point` is the offset in the LAS header. `read` must outlive the table. Throws
  /// Error{bad_file}.
  ChunkTable(const ReadBytes& read, std::uint64_t file_size, std::uint64_t first_point,
             const Compression& compression);

  /// Returns the next chunk. Throws Error{bad_file} if no chunk is left or it does not lie before
  /// the table.
  Chunk next();

 private:
  Compression compression_;
  std::uint64_t begin_ = 0, end_ = 0;  // byte range of the remaining chunks
  std::uint32_t unread_ = 0;
  std::uint32_t last_points_ = 0, last_size_ = 0;
  ArithmeticDecoder decoder_;
  IntegerCoder numbers_{32, 2};
};

}  // namespace skycap::geometry::las
