/// Images of scenes without a display: sun, sky and shadows by ray casting.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::sim {

using Rgb = std::array<std::uint8_t, 3>;

/// Image with rows from top to bottom and pixels from left to right.
struct Image {
  int width = 0;   ///< Width [px].
  int height = 0;  ///< Height [px].
  std::vector<Rgb> pixels;

  Rgb& at(int column, int row) { return pixels[static_cast<std::size_t>(row) * width + column]; }
  const Rgb& at(int column, int row) const {
    return pixels[static_cast<std::size_t>(row) * width + column];
  }
};

/// Viewpoint of an image.
struct RenderView {
  geometry::View view;
  double horizontal_fov;  ///< Full horizontal angle [rad], in (0, pi).
};

struct RenderOptions {
  int width = 1000;   ///< Image width of one view [px].
  int height = 1000;  ///< Image height of one view [px].
  int columns = 2;    ///< Number of views per row.
  /// Number of rays per pixel along each image axis, evenly spread.
  int samples_per_side = 3;
  int sky_rays = 4;  ///< Number of rays per sample that determine the visible fraction of the sky.
  /// Azimuth of the sun in each view, to the left of straight behind the viewer [rad].
  double sun_to_the_left = 0.9;
  double sun_elevation = 0.75;  ///< Elevation of the sun [rad], in (0, pi/2).
  /// Adds a level floor below the lowest vertex, which receives the shadow.
  bool has_floor = true;
  /// Maximum angle between adjacent triangles that are shaded smoothly [rad].
  double smoothing_angle = 0.5;
  /// Linear diffuse colours of the triangles, in [0, 1]. Empty: sandstone.
  std::vector<Eigen::Vector3f> colours{};
  unsigned threads = 0;  ///< 0: all processors. The image does not depend on it.
  /// Progress callback with the completed fraction, called many times per image.
  std::function<void(double share)> report{};

  /// Throws Error{bad_config} naming the first field outside its interval.
  void validate() const;
};

/// Returns four views of a scene for images with the width-to-height ratio `aspect`. They are the
/// north side, the south-west corner from a higher position, the same from high above, and a detail
/// of the second.
std::vector<RenderView> standard_views(const geometry::Mesh& mesh, double aspect = 1.0);

/// Returns the images of the views in rows of `options.columns`, from the top left. Throws the
/// errors of geometry::validate() and options.validate().
Image render(const geometry::Mesh& mesh, std::span<const RenderView> views,
             const RenderOptions& options = {});
/// Returns the images of standard_views().
Image render(const geometry::Mesh& mesh, const RenderOptions& options = {});

/// Writes a PNG with 8 bits per channel under a temporary name, then renames it. Throws
/// Error{bad_file} with the path on failure.
void write_png(const Image& image, const std::filesystem::path& path);

/// Reads a PNG of any type as 8 bits per channel without alpha. Throws Error{bad_file} with the
/// path on failure.
Image read_png(const std::filesystem::path& path);

}  // namespace skycap::sim
