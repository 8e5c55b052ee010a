/// The record by which a compressed LAS file says how it is compressed (LAZ specification 1.4,
/// section 3), and where the chunks of its points are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "geometry/io/las/byte_window.h"
#include "geometry/io/las/integer_decoder.h"

namespace skycap::geometry::las {

/// User and number of the record.
inline constexpr std::string_view compression_user = "laszip encoded";
inline constexpr std::uint16_t compression_id = 22204;

struct Compression {
  int version = 0;               ///< of the items that a point is made of
  std::uint32_t chunk_size = 0;  ///< points of each chunk but the last
  /// Chunks differ in size, and the table tells their points.
  bool has_various_chunks() const { return chunk_size == 0xFFFFFFFF; }
};

/// From the record's content. Throws Error{bad_file} unless it is of a kind that can be read: in
/// chunks; items as the format and size of points ask for them; of version 2 for points of format 0
/// to 3, of version 3 or 4 for points of format 6 to 8.
Compression parse_compression(std::string_view record, int format, std::size_t point_size);

/// The table of chunks, entry by entry: no number of chunks that a file states costs memory.
class ChunkTable {
 public:
  struct Chunk {
    std::uint64_t begin = 0, end = 0;  ///< bytes of the file
    std::uint64_t points = 0;
  };

  /// `first_point` as the header has it; `read` has to outlive the table. Throws Error{bad_file}.
  ChunkTable(const ReadBytes& read, std::uint64_t file_size, std::uint64_t first_point,
             const Compression& compression);

  /// Throws Error{bad_file} if there is none, or if it does not lie before the table.
  Chunk next();

 private:
  Compression compression_;
  std::uint64_t begin_ = 0, end_ = 0;  // of the chunks that were not asked for
  std::uint32_t unread_ = 0;
  std::uint32_t last_points_ = 0, last_size_ = 0;
  ArithmeticDecoder decoder_;
  IntegerDecoder numbers_{32, 2};
};

}  // namespace skycap::geometry::las
