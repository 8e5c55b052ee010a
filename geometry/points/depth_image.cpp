#include "geometry/points/depth_image.h"

#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <png.h>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* what, const char* reason) {
  throw Error(ErrorKind::bad_file, path.string() + ": " + what + ": " + reason);
}

}  // namespace

DepthImage depth_image(const Scan& scan, const Camera& camera, double unit) {
  DepthImage image{camera.width(), camera.height(), {}};
  image.values.resize(static_cast<std::size_t>(image.width) * image.height, 0);
  const Eigen::Isometry3d camera_from_world = scan.world_from_sensor.inverse();
  const Eigen::Vector3d axis = camera_from_world.linear().row(2);
  const double shift = camera_from_world.translation().z();
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const double depth = axis.dot(scan.points[i].cast<double>()) + shift;
    const double steps = std::round(depth / unit);
    if (steps >= 1.0 && steps <= 65535.0) {
      image.values[scan.pixels[i]] = static_cast<std::uint16_t>(steps);
    }
  }
  return image;
}

void write_depth_png(const DepthImage& image, const std::filesystem::path& path) {
  png_image png = {};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_LINEAR_Y;  // 16 bits without gamma
  png.flags = PNG_IMAGE_FLAG_FAST;
  if (png_image_write_to_file(&png, path.c_str(), 0, image.values.data(), 0, nullptr) == 0) {
    fail(path, "cannot be written", png.message);
  }
}

DepthImage read_depth_png(const std::filesystem::path& path) {
  png_image png = {};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&png, path.c_str()) == 0) {
    fail(path, "is not a PNG image", png.message);
  }
  constexpr double max_pixels = max_depth_pixels;
  const bool is_deep = (png.format & PNG_FORMAT_FLAG_LINEAR) != 0;
  if (!is_deep || static_cast<double>(png.width) * png.height > max_pixels) {
    png_image_free(&png);
    fail(path, "is not a depth image",
         is_deep ? "it has more than 25 million pixels" : "it must have 16 bits per pixel");
  }
  png.format = PNG_FORMAT_LINEAR_Y;
  DepthImage image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.values.resize(static_cast<std::size_t>(png.width) * png.height);
  if (png_image_finish_read(&png, nullptr, image.values.data(), 0, nullptr) == 0) {
    fail(path, "cannot be read", png.message);
  }
  return image;
}

}  // namespace skycap::geometry
