/// Where LAS 1.4 (ASPRS specification R15) keeps what, for its reader (cloud_io.h) and its writer
/// (missions/recording/las_format.h): places in bytes, of little-endian values.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skycap::geometry::las {

/// Of the public header block. Boxes are x, then y, then z.
namespace header {
inline constexpr std::size_t signature = 0, encoding = 6, major = 24, minor = 25, system = 26,
                             software = 58, size = 94, first_point = 96, records = 100,
                             point_format = 104, point_size = 105, scale = 131, offset = 155,
                             bounds = 179,  // the largest x, then the smallest; so y and z
    points = 247, points_by_return = 255, end = 375;
}  // namespace header

/// Of a variable length record, from its beginning.
namespace record {
inline constexpr std::size_t user = 2, id = 18, length = 20, description = 22, end = 54;
}  // namespace record

/// Of a point of format 6 or 7, from its beginning.
namespace point {
inline constexpr std::size_t position = 0, intensity = 12, returns = 14, flags = 15,
                             classification = 16, user_data = 17, scan_angle = 18, source = 20,
                             time = 22, colour = 30;
inline constexpr std::uint8_t withheld = 1 << 2;  // of the flags
}  // namespace point

/// Format 7 has three colours of 16 bits behind what format 6 has.
constexpr std::uint16_t point_size(int format) { return format == 7 ? 36 : 30; }

}  // namespace skycap::geometry::las
