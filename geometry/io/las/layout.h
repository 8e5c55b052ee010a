/// Layout of LAS 1.0 to 1.4 (ASPRS specification R15), for the reader (las_reader.h) and the writer
/// (las_writer.h). Offsets are in bytes; values are little-endian.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace skycap::geometry::las {

inline constexpr int compressed_bit = 0x80;  ///< flag in the point format of the header

/// Offsets in the public header block. Vectors and boxes are in the order x, y, z.
namespace header {
inline constexpr std::size_t signature = 0, encoding = 6, major = 24, minor = 25, system = 26,
                             software = 58, size = 94, first_point = 96, records = 100,
                             point_format = 104, point_size = 105, old_points = 107, scale = 131,
                             offset = 155,
                             bounds = 179,  // max x, min x, max y, min y, max z, min z
    first_extended_record = 235, extended_records = 243, points = 247, points_by_return = 255,
                             end = 375;
inline constexpr std::size_t old_end = 227;  // header size of versions before 1.3
}  // namespace header

/// Offsets in a variable length record.
namespace record {
inline constexpr std::size_t user = 2, id = 18, length = 20, description = 22, end = 54;
inline constexpr std::size_t extended_end = 60;  // the length field has 8 bytes
inline constexpr std::size_t user_size = 16;
inline constexpr const char* projection = "LASF_Projection";  // user ID of the record IDs below
inline constexpr std::uint16_t wkt = 2112, geo_keys = 34735;
inline constexpr const char* specification = "LASF_Spec";
inline constexpr std::uint16_t extra_bytes = 4;
}  // namespace record

/// Offsets in a point of format 6 to 10.
namespace point {
inline constexpr std::size_t position = 0, intensity = 12, returns = 14, flags = 15,
                             classification = 16, user_data = 17, scan_angle = 18, source = 20,
                             time = 22, colour = 30;
inline constexpr std::uint8_t withheld = 1 << 2;  // bit of the flags
inline constexpr double scan_angle_unit_deg = 0.006;
}  // namespace point

/// Offsets in a point of format 0 to 5 that differ from those of format 6 to 10.
namespace old_point {
inline constexpr std::size_t classification = 15;
inline constexpr std::uint8_t classes = 31, withheld = 1 << 7;  // bits of the classification
}  // namespace old_point

inline constexpr std::array<std::uint16_t, 11> point_sizes = {20, 28, 26, 34, 57, 63,
                                                              30, 36, 38, 59, 67};
constexpr std::uint16_t point_size(int format) {
  return point_sizes[static_cast<std::size_t>(format)];
}

/// Offset of the 16-bit colours for each point format, or zero if the format has no colours.
inline constexpr std::array<std::uint8_t, 11> colour_offsets = {0, 0,  20, 28, 0, 28,
                                                                0, 30, 30, 0,  30};

}  // namespace skycap::geometry::las
