/// Bytes of LAS 1.4 files (ASPRS specification R15) with point formats 6 to 8, also compressed
/// (LAZ), for files that grow.
#pragma once

#include <array>
#include <cstdint>
#include <istream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/byte_values.h"
#include "geometry/io/las/layout.h"

namespace skycap::geometry::las {

/// Variable length record. The content has at most 65535 bytes.
struct WrittenRecord {
  std::string_view user;
  std::uint16_t id = 0;
  std::string_view description;
  std::string content;
};

/// Returns the record of a reference system, of at most 65534 bytes.
WrittenRecord wkt_record(std::string_view wkt);

/// Returns the record that describes the compression. A chunk size of zero means that it varies.
WrittenRecord compression_record(int point_format, std::size_t point_size,
                                 std::uint32_t chunk_size = 0);

/// Header fields of a file.
struct WrittenFile {
  int point_format = 6;
  std::uint16_t extra_bytes = 0;  ///< additional bytes of a point
  bool is_compressed = false;     ///< requires a compression record
  bool has_week_time = false;     ///< times are seconds of the week, not adjusted GPS time
  std::string_view system = "simulation";
  std::vector<WrittenRecord> records;  ///< records before the points
  Eigen::Vector3d scale =
      Eigen::Vector3d::Constant(1e-4);  ///< coordinate: offset + integer * scale
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::uint64_t points = 0;
  std::array<std::uint64_t, 15> points_by_return = {};
  Eigen::AlignedBox3d bounds;  ///< bounding box of the written coordinates
};

/// Returns the public header block and the records. The length does not depend on the points. The
/// creation date is zero, so that equal input gives equal bytes.
std::vector<std::uint8_t> make_header(const WrittenFile& file);

/// Returns the content of the chunk table of a compressed file.
struct WrittenChunk {
  std::uint32_t points = 0, bytes = 0;
};
std::string chunk_table(std::span<const WrittenChunk> chunks, bool has_various_sizes);

/// Reads the chunks of a compressed file that this writer has written, from the first chunk at
/// `begin` to `end`. Throws Error{bad_file} without the name of the file.
std::vector<WrittenChunk> find_chunks(std::istream& file, std::uint64_t begin, std::uint64_t end,
                                      int point_format, std::size_t point_size);

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
