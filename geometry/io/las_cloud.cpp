#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "geometry/io/cloud_parsers.h"
#include "geometry/io/las_layout.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

/// A value of a binary file at a place that is known to be inside.
template <typename Value>
Value at(std::string_view bytes, std::size_t place) {
  static_assert(std::endian::native == std::endian::little, "LAS files are little-endian");
  Value value;
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

struct LasHeader {
  std::uint64_t points = 0;
  std::size_t first_point = 0, point_size = 0;
  bool has_colours = false;
  Eigen::Vector3d scale, offset;
};

LasHeader header_of(const fs::path& path, std::string_view bytes) {
  if (bytes.size() <= las::header::point_format || !bytes.starts_with("LASF")) {
    fail_cloud(path, "is not a LAS file: it does not begin with a LAS header");
  }
  const int major = at<std::uint8_t>(bytes, las::header::major),
            minor = at<std::uint8_t>(bytes, las::header::minor);
  const int format = at<std::uint8_t>(bytes, las::header::point_format);
  const std::string what = "is LAS " + std::to_string(major) + "." + std::to_string(minor) +
                           " with points of format " + std::to_string(format & 0x3F) +
                           ((format & 0x80) != 0 ? ", compressed (LAZ)" : "");
  if (major != 1 || minor != 4 || (format != 6 && format != 7)) {
    fail_cloud(path, what +
                         "; only LAS 1.4 with points of format 6 or 7, not compressed, can be "
                         "read: convert it");
  }
  if (bytes.size() < las::header::end) fail_cloud(path, "ends within the header");
  LasHeader header;
  header.first_point = at<std::uint32_t>(bytes, las::header::first_point);
  header.point_size = at<std::uint16_t>(bytes, las::header::point_size);
  header.points = at<std::uint64_t>(bytes, las::header::points);
  header.has_colours = format == 7;
  for (int axis = 0; axis < 3; ++axis) {
    header.scale[axis] = at<double>(bytes, las::header::scale + 8UL * axis);
    header.offset[axis] = at<double>(bytes, las::header::offset + 8UL * axis);
  }
  const std::size_t least_size = las::point_size(format);
  if (header.point_size < least_size) {
    fail_cloud(path, "has points of " + std::to_string(header.point_size) +
                         " bytes; those of format " + std::to_string(format) + " have " +
                         std::to_string(least_size) + " or more");
  }
  if (!header.scale.allFinite() || !(header.scale.array() > 0.0).all() ||
      !header.offset.allFinite()) {
    fail_cloud(path, "has a scale or an offset of coordinates that is not a usable number");
  }
  if (header.first_point < las::header::end) {
    fail_cloud(path, "says that its points begin within its header");
  }
  const std::size_t room =
      bytes.size() < header.first_point ? 0 : (bytes.size() - header.first_point);
  if (room / header.point_size < header.points) {
    fail_cloud(path, "ends after " + std::to_string(room / header.point_size) + " of its " +
                         std::to_string(header.points) + " points");
  }
  return header;
}

}  // namespace

AttributedCloud parse_las_cloud(const fs::path& path, std::string_view bytes) {
  const LasHeader header = header_of(path, bytes);
  AttributedCloud cloud;
  for (std::size_t i = 0; i < header.points; ++i) {
    const std::size_t place = header.first_point + i * header.point_size;
    if ((at<std::uint8_t>(bytes, place + las::point::flags) & las::point::withheld) != 0) continue;
    Eigen::Vector3d position;
    for (int axis = 0; axis < 3; ++axis) {
      position[axis] =
          at<std::int32_t>(bytes, place + las::point::position + 4UL * axis) * header.scale[axis] +
          header.offset[axis];
    }
    cloud.positions.push_back(cloud_position(path, i, position.x(), position.y(), position.z()));
    if (!header.has_colours) continue;
    auto& colour = cloud.colours.emplace_back();
    for (std::size_t channel = 0; channel < 3; ++channel) {
      colour[channel] = static_cast<std::uint8_t>(
          at<std::uint16_t>(bytes, place + las::point::colour + 2 * channel) >> 8);
    }
  }
  return cloud;
}

}  // namespace skycap::geometry
