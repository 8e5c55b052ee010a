/// Bytes of LAS 1.4 files (ASPRS specification R15) with point format 6 or 7, for files that grow
/// during a measurement.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/byte_values.h"
#include "geometry/io/las/layout.h"

namespace skycap::geometry::las {

/// Header fields of a file.
struct WrittenFile {
  int point_format = 6;      ///< 7 adds a colour: the intensity as grey
  std::string_view crs_wkt;  ///< at most 65534 bytes
  double scale = 1e-4;       ///< coordinates are offset + integer * scale
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::uint64_t points = 0;
  std::array<std::uint64_t, 15> points_by_return = {};
  Eigen::AlignedBox3d bounds;  ///< bounding box of the written coordinates
};

/// Returns the public header block and the record of the reference system. The length does not
/// depend on the points. The creation date is zero, so that equal input gives equal bytes.
std::vector<std::uint8_t> make_header(const WrittenFile& file);

struct WrittenPoint {
  std::array<std::int32_t, 3> position = {};  ///< multiples of the scale from the offset
  std::uint16_t intensity = 0;
  std::uint8_t return_number = 1, returns = 1;
  std::uint8_t user_data = 0;
  std::int16_t scan_angle = 0;  ///< multiples of point::scan_angle_unit_deg
  double time = 0.0;            ///< [s]
};

/// Writes an unclassified point of the first flight line to `bytes`, which must have room for
/// point_size() bytes.
inline void put_point(std::uint8_t* bytes, int point_format, const WrittenPoint& written) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put_value(bytes, point::position + 4 * axis, written.position[axis]);
  }
  put_value(bytes, point::intensity, written.intensity);
  bytes[point::returns] = static_cast<std::uint8_t>(written.return_number | (written.returns << 4));
  bytes[point::flags] = 0;
  bytes[point::classification] = 0;
  bytes[point::user_data] = written.user_data;
  put_value(bytes, point::scan_angle, written.scan_angle);
  put_value(bytes, point::source, std::uint16_t{1});
  put_value(bytes, point::time, written.time);
  if (point_format == 6) return;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    put_value(bytes, point::colour + 2 * channel, written.intensity);
  }
}

}  // namespace skycap::geometry::las
