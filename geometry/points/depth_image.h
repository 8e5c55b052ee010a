/// Depth images in the format of common datasets: 16-bit greyscale PNG.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"

namespace skycap::geometry {

/// Depths along the optical axis as multiples of a unit. Zero marks a no-return pixel or a depth
/// that exceeds 16 bits.
struct DepthImage {
  int width = 0, height = 0;          ///< [px]
  std::vector<std::uint16_t> values;  ///< row-major
};

/// Maximum number of pixels of an image that is read.
inline constexpr int max_depth_pixels = 25'000'000;

/// Converts an organised scan to a depth image. `unit` is the depth of one step [m].
DepthImage depth_image(const Scan& scan, const Camera& camera, double unit);

/// Throws Error{bad_file} if the file cannot be written.
void write_depth_png(const DepthImage& image, const std::filesystem::path& path);

/// Throws Error{bad_file} if the file is not a 16-bit PNG image or has more than max_depth_pixels.
DepthImage read_depth_png(const std::filesystem::path& path);

}  // namespace skycap::geometry
