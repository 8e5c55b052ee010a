#include "clients/ros2/sensor_scan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>

#include "clients/ros2/throttled_warnings.h"
#include "geometry/error.h"

namespace skycap::ros2 {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

[[noreturn]] void reject(const std::string& what) { throw Error(ErrorKind::bad_geometry, what); }

/// Returns a number from any address in either byte order.
template <typename Number>
Number number_at(const std::uint8_t* bytes, bool is_big_endian) {
  std::array<std::uint8_t, sizeof(Number)> own;
  std::memcpy(own.data(), bytes, own.size());
  if (is_big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(own);
  return std::bit_cast<Number>(own);
}

/// PointField data types of coordinates.
constexpr std::uint8_t float32 = 7, float64 = 8;

struct Coordinate {
  std::uint32_t offset;
  bool is_double;

  float at(const std::uint8_t* point, bool is_big_endian) const {
    return is_double ? static_cast<float>(number_at<double>(point + offset, is_big_endian))
                     : number_at<float>(point + offset, is_big_endian);
  }
};

Coordinate coordinate(const PointCloud2& cloud, const std::string& name) {
  std::optional<Coordinate> found;
  for (std::uint32_t i = 0; i < cloud.fields._length; ++i) {
    const PointField& field = cloud.fields._buffer[i];
    if (printable_text(field.name) != name) continue;
    if (found) reject("its field " + name + " is listed twice");
    if (field.datatype != float32 && field.datatype != float64) {
      reject("its field " + name + " has the type " + std::to_string(field.datatype) +
             "; it must be FLOAT32 (7) or FLOAT64 (8)");
    }
    if (field.count > 1) reject("its field " + name + " has more than one value per point");
    found = {field.offset, field.datatype == float64};
    const std::uint64_t end = std::uint64_t{field.offset} + (found->is_double ? 8 : 4);
    if (end > cloud.point_step) {
      reject("its field " + name + " ends at byte " + std::to_string(end) + " of points of " +
             std::to_string(cloud.point_step));
    }
  }
  if (!found) reject("missing field " + name);
  return *found;
}

/// Rows of `width` elements of `size` bytes, with `data` bytes in total.
struct Rows {
  std::uint32_t height, width, size, step;
  std::uint64_t data;
};

void require_whole(const Rows& rows) {
  const auto text = [](auto number) { return std::to_string(number); };
  if (std::uint64_t{rows.width} * rows.size > rows.step) {
    reject("its rows have " + text(rows.step) + " bytes; " + text(rows.width) + " times " +
           text(rows.size) + " require more");
  }
  if (std::uint64_t{rows.step} * rows.height != rows.data) {
    reject("it has " + text(rows.data) + " bytes; it must have " + text(rows.height) + " x " +
           text(rows.step) + " (rows x bytes per row)");
  }
}

void require_points(std::uint64_t points) {
  // `serve` accepts up to 256 MiB per message.
  constexpr std::uint64_t max = (std::uint64_t{256} << 20) / (3 * sizeof(float));
  if (points > max) {
    reject("it has " + std::to_string(points) + " points; the maximum is " + std::to_string(max) +
           " per scan");
  }
}

/// Returns the pixels row by row in the given number type.
template <typename Number>
std::vector<Number> read_pixels(const Image& image) {
  std::vector<Number> pixels;
  pixels.reserve(std::size_t{image.width} * image.height);
  for (std::uint32_t row = 0; row < image.height; ++row) {
    const std::uint8_t* line = image.data._buffer + std::size_t{row} * image.step;
    for (std::uint32_t column = 0; column < image.width; ++column) {
      pixels.push_back(
          number_at<Number>(line + std::size_t{column} * sizeof(Number), image.is_bigendian != 0));
    }
  }
  return pixels;
}

void require_image(const Image& image, std::uint32_t pixel, const CameraIntrinsics& intrinsics) {
  constexpr std::uint32_t largest_side = 1 << 15;
  if (image.width < 1 || image.height < 1 || image.width > largest_side ||
      image.height > largest_side) {
    reject("its size is " + std::to_string(image.width) + " x " + std::to_string(image.height) +
           "; each side must be from 1 to 32768 pixels");
  }
  if (image.width != intrinsics.width || image.height != intrinsics.height) {
    reject("its size is " + std::to_string(image.width) + " x " + std::to_string(image.height) +
           "; its CameraInfo has " + std::to_string(intrinsics.width) + " x " +
           std::to_string(intrinsics.height));
  }
  require_points(std::uint64_t{image.width} * image.height);
  require_whole({image.height, image.width, pixel, image.step, image.data._length});
}

/// Returns points from depths along the optical axis [m].
CloudScan make_cloud(const Image& image, const CameraIntrinsics& intrinsics) {
  const std::vector<float> depths = read_pixels<float>(image);
  CloudScan scan;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const double depth = depths[i];
    if (!std::isfinite(depth) || depth <= 0.0) continue;
    const auto u = static_cast<double>(i % image.width), v = static_cast<double>(i / image.width);
    for (const double value :
         {(u - intrinsics.intrinsics[2]) / intrinsics.intrinsics[0] * depth,
          (v - intrinsics.intrinsics[3]) / intrinsics.intrinsics[1] * depth, depth}) {
      scan.xyz.push_back(static_cast<float>(value));
    }
  }
  return scan;
}

/// Returns k1 k2 p1 p2 k3. Empty without distortion.
std::vector<double> read_distortion(const CameraInfo& info) {
  std::vector<double> d(info.d._buffer, info.d._buffer + info.d._length);
  if (std::ranges::any_of(d, [](double value) { return !std::isfinite(value); })) {
    reject("its D is not finite");
  }
  while (!d.empty() && d.back() == 0.0) d.pop_back();
  if (d.empty()) return d;
  const std::string model = printable_text(info.distortion_model);
  // The first five coefficients of rational_polynomial are those of plumb_bob.
  if ((model != "plumb_bob" && model != "rational_polynomial" && !model.empty()) || d.size() > 5) {
    reject("its distortion is '" + model + "' with " + std::to_string(d.size()) +
           " coefficients; use plumb_bob with k1 k2 p1 p2 k3, or send rectified images");
  }
  d.resize(5, 0.0);
  return d;
}

}  // namespace

CloudScan make_scan(const PointCloud2& cloud, Axes axes) {
  require_points(std::uint64_t{cloud.width} * cloud.height);
  require_whole({cloud.height, cloud.width, cloud.point_step, cloud.row_step, cloud.data._length});
  const std::array<Coordinate, 3> columns{coordinate(cloud, "x"), coordinate(cloud, "y"),
                                          coordinate(cloud, "z")};
  const Matrix3f turn = optical_from(axes).cast<float>();
  CloudScan scan;
  if (cloud.width == 0) return scan;  // The number of rows may be in the billions.
  scan.xyz.reserve(std::size_t{3} * cloud.width * cloud.height);
  for (std::uint32_t row = 0; row < cloud.height; ++row) {
    const std::uint8_t* point = cloud.data._buffer + std::size_t{row} * cloud.row_step;
    for (std::uint32_t i = 0; i < cloud.width; ++i, point += cloud.point_step) {
      Vector3f position;
      for (int k = 0; k < 3; ++k) {
        position[k] = columns[static_cast<std::size_t>(k)].at(point, cloud.is_bigendian);
      }
      if (!position.allFinite() || (position.array() == 0.0F).all()) continue;
      if (axes != Axes::optical) position = turn * position;
      scan.xyz.insert(scan.xyz.end(), position.begin(), position.end());
    }
  }
  return scan;
}

CameraIntrinsics to_intrinsics(const CameraInfo& info, bool is_rectified) {
  if (info.binning_x > 1 || info.binning_y > 1)
    reject("binning is not supported; send full images");
  const auto& roi = info.roi;
  const bool is_whole = roi.x_offset == 0 && roi.y_offset == 0 &&
                        (roi.width == 0 || roi.width == info.width) &&
                        (roi.height == 0 || roi.height == info.height);
  if (!is_whole) reject("regions of interest are not supported; send full images");
  CameraIntrinsics intrinsics{.width = info.width, .height = info.height, .intrinsics = {}};
  if (is_rectified) {
    intrinsics.intrinsics = {info.p[0], info.p[5], info.p[2], info.p[6]};
  } else {
    intrinsics.intrinsics = {info.k[0], info.k[4], info.k[2], info.k[5]};
    std::ranges::copy(read_distortion(info), std::back_inserter(intrinsics.intrinsics));
  }
  const bool is_valid = std::ranges::all_of(intrinsics.intrinsics,
                                            [](double value) { return std::isfinite(value); }) &&
                        intrinsics.intrinsics[0] > 0.0 && intrinsics.intrinsics[1] > 0.0;
  if (!is_valid) reject("invalid focal length or principal point");
  return intrinsics;
}

SensorScan make_scan(const Image& image, const CameraIntrinsics& intrinsics) {
  const std::string encoding = printable_text(image.encoding);
  if (encoding == "16UC1" || encoding == "mono16") {
    require_image(image, sizeof(std::uint16_t), intrinsics);
    return DepthScan{.depth = read_pixels<std::uint16_t>(image),
                     .width = static_cast<int>(image.width),
                     .height = static_cast<int>(image.height),
                     .intrinsics = intrinsics.intrinsics};
  }
  if (encoding != "32FC1") {
    reject("its encoding is '" + encoding + "'; depth must be 16UC1 or 32FC1");
  }
  if (intrinsics.is_distorted()) {
    reject("distortion is not supported for this encoding; rectify the image, or send 16UC1");
  }
  require_image(image, sizeof(float), intrinsics);
  return make_cloud(image, intrinsics);
}

}  // namespace skycap::ros2
