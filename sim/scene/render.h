/// Pictures of scenes, without a display: sun, sky and shadows by ray casting.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/pose.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::sim {

using Rgb = std::array<std::uint8_t, 3>;

/// Rows from the top down, pixels from left to right.
struct Image {
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  std::vector<Rgb> pixels;

  Rgb& at(int column, int row) { return pixels[static_cast<std::size_t>(row) * width + column]; }
  const Rgb& at(int column, int row) const {
    return pixels[static_cast<std::size_t>(row) * width + column];
  }
};

/// One picture's point of view.
struct RenderView {
  geometry::View view;
  double horizontal_fov;  ///< full angle [rad], in (0, pi)
};

struct RenderOptions {
  int width = 1000;   ///< of the picture of one view [px]
  int height = 1000;  ///< of the picture of one view [px]
  int columns = 2;    ///< views side by side in a row
  /// The rays through a pixel's square, evenly spread, are its side squared.
  int samples_per_side = 3;
  int sky_rays = 4;  ///< for each of those: rays that ask how much of the sky is open
  /// Where the sun stands in each view: this far to the left of straight behind the viewer [rad],
  double sun_to_the_left = 0.9;
  double sun_elevation = 0.75;  ///< and this high [rad], in (0, pi/2)
  bool has_floor = true;  ///< adds a level floor under the lowest vertex that takes the shadow
  /// Corners between triangles flatter than this are shaded as if they were round [rad].
  double smoothing_angle = 0.5;
  /// Diffuse colours of the triangles, linear, in [0, 1]; empty: all are of sandstone.
  std::vector<Eigen::Vector3f> colours{};
  unsigned threads = 0;  ///< zero: all processors. The picture does not depend on it.
  std::function<void(double share)> report{};  ///< told how much is drawn, many times a picture

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

/// Four views of a scene, for pictures whose width is `aspect` times their height: the north side,
/// the south-west corner from higher up, the same from high up, and a detail of the second.
std::vector<RenderView> standard_views(const geometry::Mesh& mesh, double aspect = 1.0);

/// The views' pictures in rows of `options.columns`, from the top left. Throws what
/// geometry::validate() and options.validate() throw.
Image render(const geometry::Mesh& mesh, std::span<const RenderView> views,
             const RenderOptions& options = {});
/// The same of standard_views().
Image render(const geometry::Mesh& mesh, const RenderOptions& options = {});

/// Writes a PNG of 8 bits a channel under a temporary name, then renames it. Throws
/// Error{bad_file} naming the path if it cannot be written.
void write_png(const Image& image, const std::filesystem::path& path);

/// Reads a PNG of any kind as 8 bits a channel, without alpha. Throws Error{bad_file} naming the
/// path if it cannot be read.
Image read_png(const std::filesystem::path& path);

}  // namespace skycap::sim
