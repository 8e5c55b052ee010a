/// Simulated photos of a textured scene from planned poses.
///
/// Each sample of a pixel is computed with a ray through the camera model, including distortion.
/// The texture is solid, so that a surface point has the same albedo in every photo. It uses no
/// trigonometric or exponential functions, so that the same scene and seed give identical bytes on
/// all platforms.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/photo_camera.h"
#include "geometry/pose/pose.h"
#include "sim/scene/scene.h"

namespace skycap::sim {

/// Image with one channel. Rows are stored from top to bottom.
struct GreyImage {
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  std::vector<std::uint8_t> pixels;

  std::uint8_t at(int column, int row) const {
    return pixels[static_cast<std::size_t>(row) * width + column];
  }
};

/// Returns value noise in [-1, 1] with features of size 1: smooth interpolation between random
/// values at the corners of the unit grid. Octaves are independent.
double value_noise(const Eigen::Vector3d& point, std::uint32_t octave);

/// Returns the albedo of a surface point in [0, 1]: 0.5 + `contrast` times noise with wavelengths
/// of 1.7, 4.3, 13 and 60 `gsd`. The wavelengths provide texture at all scales of matching.
double textured_albedo(const Eigen::Vector3d& point, double gsd, double contrast);

struct PhotoOptions {
  double gsd =
      0.01;  ///< GSD of the photos on the target, which defines the scale of the texture [m].
  double contrast = 1.0;  ///< Contrast of the texture.
  double ground = -1e30;  ///< z of a level ground below the scene [m]. Default: no ground.
  Eigen::Vector3d to_sun{0.4, -0.5,
                         0.77};  ///< Direction to the sun. Normalisation is not required.
  double noise = 2.0;            ///< Standard deviation of a pixel's noise [grey levels of 255].
  int samples_per_side = 2;      ///< Samples per pixel in each direction.
  /// Translation of the camera during the exposure, in the world frame [m].
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  std::uint64_t seed = 1;  ///< Seed of the noise.
  unsigned threads = 0;    ///< Zero: all processors. Does not affect the photo.

  /// Throws Error{bad_config} with the name of the first field outside its interval.
  void validate() const;
};

/// Returns the photo of a view, including the camera's distortion. Throws the same errors as
/// options.validate() and PhotoCamera.
GreyImage simulate_photo(const Scene& scene, const geometry::PhotoCamera& camera,
                         const geometry::View& view, const PhotoOptions& options);

/// Writes a PNG with one channel of 8 bits, like write_png() in sim/scene/render.h.
void write_png(const GreyImage& image, const std::filesystem::path& path);

}  // namespace skycap::sim
