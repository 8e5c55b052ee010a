/// Where an E57 file keeps what (ASTM E2807-11, 6, 7 and 9), for its reader and its writer: places
/// in bytes, of little-endian values.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skycap::geometry::e57 {

/// Of the file's header, which has no checksum within it.
namespace header {
inline constexpr std::size_t signature = 0, major = 8, minor = 12, file_size = 16, description = 24,
                             description_size = 32, page_size = 40, size = 48;
}  // namespace header

/// Of the beginning of a scan's records. Where they are is a physical place.
namespace section {
inline constexpr std::size_t kind = 0, length = 8, data = 16, index = 24, size = 32;
inline constexpr char of_records = 1;
}  // namespace section

/// Of a packet: its streams' lengths have two bytes each, the streams follow. Its size is a
/// multiple of the least one.
namespace packet {
inline constexpr std::size_t kind = 0, size_less_one = 2, streams = 4, lengths = 6, least_size = 4,
                             largest_size = 65536;
inline constexpr std::uint8_t data = 1, empty = 2;  // kinds; 0 is an index
}  // namespace packet

}  // namespace skycap::geometry::e57
