/// Photos of a textured scene: what a photo camera at a planned pose takes.
///
/// Pixels are exact: a ray through the camera model, distortion included, for each sample of a
/// pixel. The texture is solid, so that a surface point has the same albedo in every photo. It uses
/// neither trigonometric nor exponential functions: the same scene and seed give the same bytes
/// everywhere.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/photo_camera.h"
#include "geometry/pose/pose.h"
#include "sim/scene/scene.h"

namespace skycap::sim {

/// An image of one channel, rows from the top down.
struct GreyImage {
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  std::vector<std::uint8_t> pixels;

  std::uint8_t at(int column, int row) const {
    return pixels[static_cast<std::size_t>(row) * width + column];
  }
};

/// Value noise in [-1, 1] with features of size 1: smooth interpolation between random values at
/// the corners of the unit grid. Different octaves are unrelated.
double value_noise(const Eigen::Vector3d& point, std::uint32_t octave);

/// Albedo of a surface point, in [0, 1]: 0.5 and `contrast` times noise of wavelengths 1.7, 4.3, 13
/// and 60 `gsd`, which gives every scale of matching something to match.
double textured_albedo(const Eigen::Vector3d& point, double gsd, double contrast);

struct PhotoOptions {
  double gsd = 0.01;      ///< of the texture, that of the photos on the target [m]
  double contrast = 1.0;  ///< of the texture
  double ground = -1e30;  ///< z of a level ground under the scene; the default: none [m]
  Eigen::Vector3d to_sun{0.4, -0.5, 0.77};  ///< direction; need not be a unit vector
  double noise = 2.0;                       ///< standard deviation of a pixel, of 255 grey levels
  int samples_per_side = 2;                 ///< a pixel has their square
  /// How far the camera moves during the exposure, in the world frame [m].
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  std::uint64_t seed = 1;  ///< of the noise
  unsigned threads = 0;    ///< zero: all processors. The photo does not depend on it.

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

/// The photo of a view, with the camera's distortion. Throws what options.validate() and
/// PhotoCamera throw.
GreyImage simulate_photo(const Scene& scene, const geometry::PhotoCamera& camera,
                         const geometry::View& view, const PhotoOptions& options);

/// Writes a PNG of one channel of 8 bits, as write_png() in sim/scene/render.h does.
void write_png(const GreyImage& image, const std::filesystem::path& path);

}  // namespace skycap::sim
