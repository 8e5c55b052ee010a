/// Layout of E57 files (ASTM E2807-11, sections 6, 7 and 9), for reader and writer. Offsets are in
/// bytes; values are little-endian.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skycap::geometry::e57 {

/// Offsets in the file header, which has no checksum of its own.
namespace header {
inline constexpr std::size_t signature = 0, major = 8, minor = 12, file_size = 16, description = 24,
                             description_size = 32, page_size = 40, size = 48;
}  // namespace header

/// Offsets in the header of a compressed vector section. Section offsets are physical.
namespace section {
inline constexpr std::size_t kind = 0, length = 8, data = 16, index = 24, size = 32;
inline constexpr char compressed_vector = 1;
}  // namespace section

/// Offsets in a data packet. The stream lengths of two bytes each are followed by the streams. The
/// packet size is a multiple of `min_size`.
namespace packet {
inline constexpr std::size_t kind = 0, size_less_one = 2, streams = 4, lengths = 6, min_size = 4,
                             largest_size = 65536;
inline constexpr std::uint8_t data = 1, empty = 2;  // packet types; 0 is an index packet
}  // namespace packet

}  // namespace skycap::geometry::e57
