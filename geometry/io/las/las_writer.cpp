#include "geometry/io/las/las_writer.h"

#include <algorithm>

namespace skycap::geometry::las {

// All other bytes stay zero: the legacy counts, which are unused for point formats 6 and above, and
// the missing waveforms and extended records.
std::vector<std::uint8_t> make_header(const WrittenFile& file) {
  const std::size_t wkt_size = file.crs_wkt.size() + 1;  // including the terminating zero
  constexpr std::size_t first_record = header::end, wkt = first_record + record::end;
  constexpr std::uint16_t adjusted_time = 1, is_wkt = 1 << 4;
  std::vector<std::uint8_t> bytes(wkt + wkt_size);
  const auto put = [&](std::size_t offset, auto value) { put_value(bytes.data(), offset, value); };
  const auto put_text = [&](std::size_t offset, std::string_view text) {
    std::ranges::copy(text, bytes.begin() + static_cast<std::ptrdiff_t>(offset));
  };
  put_text(header::signature, "LASF");
  put(header::encoding, static_cast<std::uint16_t>(adjusted_time | is_wkt));
  put(header::major, std::uint8_t{1});
  put(header::minor, std::uint8_t{4});
  put_text(header::system, "simulation");
  put_text(header::software, "Skycap");
  put(header::size, static_cast<std::uint16_t>(header::end));
  put(header::first_point, static_cast<std::uint32_t>(bytes.size()));
  put(header::records, std::uint32_t{1});
  put(header::point_format, static_cast<std::uint8_t>(file.point_format));
  put(header::point_size, point_size(file.point_format));
  for (int axis = 0; axis < 3; ++axis) {
    put(header::scale + 8UL * axis, file.scale);
    put(header::offset + 8UL * axis, file.offset[axis]);
    if (file.points == 0) continue;
    put(header::bounds + 16UL * axis, file.bounds.max()[axis]);
    put(header::bounds + 16UL * axis + 8, file.bounds.min()[axis]);
  }
  put(header::points, file.points);
  for (std::size_t i = 0; i < file.points_by_return.size(); ++i) {
    put(header::points_by_return + 8 * i, file.points_by_return[i]);
  }
  put_text(first_record + record::user, record::projection);
  put(first_record + record::id, record::wkt);
  put(first_record + record::length, static_cast<std::uint16_t>(wkt_size));
  put_text(first_record + record::description, "OGC coordinate system WKT");
  put_text(wkt, file.crs_wkt);
  return bytes;
}

}  // namespace skycap::geometry::las
