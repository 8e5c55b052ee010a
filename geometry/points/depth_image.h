/// Depth images as datasets store them: 16-bit grey PNG, one value a pixel.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "geometry/place/camera.h"
#include "geometry/points/scan.h"

namespace skycap::geometry {

/// Depth along the optical axis in steps; zero where there was no return, or one too far for 16
/// bits.
struct DepthImage {
  int width = 0, height = 0;          ///< [px]
  std::vector<std::uint16_t> values;  ///< row by row
};

/// Of an image that is read.
inline constexpr int most_depth_pixels = 25'000'000;

/// The image of an organised scan. `unit` is what one step stands for [m].
DepthImage depth_image(const Scan& scan, const Camera& camera, double unit);

/// Throws Error{bad_file} if the file cannot be written.
void write_depth_png(const DepthImage& image, const std::filesystem::path& path);

/// Throws Error{bad_file} if it is not a PNG picture of 16 bits, or has more than
/// most_depth_pixels.
DepthImage read_depth_png(const std::filesystem::path& path);

}  // namespace skycap::geometry
