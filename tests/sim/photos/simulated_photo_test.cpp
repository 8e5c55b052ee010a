// Simulated photos: exact intrinsics, solid texture and reproducible bytes.
#include "sim/photos/simulated_photo.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/pose/brown_distortion.h"
#include "geometry/random_numbers.h"
#include "tests/sim/photos/wall.h"
#include "tests/support/complaint.h"

namespace skycap::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Properties of the noise: bounded, smooth, not constant, and different in each octave.
TEST(ValueNoise, IsBoundedAndContinuous) {
  geometry::RandomNumbers random(7);
  double sum = 0.0, squares = 0.0, min = 1.0, max = -1.0, same = 0.0;
  constexpr int count = 4000;
  for (int i = 0; i < count; ++i) {
    const Vector3d point{random.between(-90, 90), random.between(-90, 90), random.between(-9, 9)};
    const double value = value_noise(point, 0);
    min = std::min(min, value), max = std::max(max, value);
    sum += value, squares += value * value;
    same += value * value_noise(point, 1);
    EXPECT_NEAR(value, value_noise(point + Vector3d(1e-7, -1e-7, 1e-7), 0), 1e-5);
  }
  EXPECT_GE(min, -1.0);
  EXPECT_LE(max, 1.0);
  EXPECT_NEAR(sum / count, 0.0, 0.02);
  EXPECT_GT(squares / count, 0.05);
  EXPECT_NEAR(same / count, 0.0, 0.01) << "octaves are not independent";
}

TEST(Texture, HasTheContrastThatIsAskedFor) {
  EXPECT_EQ(textured_albedo({1, 2, 3}, 0.01, 0.0), 0.5);
  EXPECT_NE(textured_albedo({1, 2, 3}, 0.01, 1.0), textured_albedo({1.01, 2, 3}, 0.01, 1.0));
}

// The grey value of a pixel is that of the wall point at the same pixel in the camera model, with
// and without distortion.
TEST(SimulatedPhoto, ShowsEachPointWhereTheCameraProjectsIt) {
  const Scene scene(wall_at(5.0));
  PhotoOptions options{.gsd = 0.2, .to_sun = {0, -1, 0}, .noise = 0.0, .samples_per_side = 1};
  for (const bool is_distorted : {false, true}) {
    geometry::PhotoCameraConfig config = small_camera();
    if (is_distorted) config.distortion = geometry::BrownDistortion{.k1 = -0.2, .p1 = 0.01};
    const geometry::PhotoCamera camera(config);
    const geometry::View view{{0, 0, 0}, Vector3d::UnitY()};
    const GreyImage image = simulate_photo(scene, camera, view, options);
    ASSERT_EQ(image.width, 80);
    ASSERT_EQ(image.height, 60);
    for (int column = 5; column < 80; column += 10) {
      for (int row = 5; row < 60; row += 10) {
        Vector2d slope =
            (Vector2d(column, row) - camera.principal_point_px()) / camera.focal_length_px();
        if (is_distorted) slope = geometry::undistort(*config.distortion, slope);
        const Vector3d point(5.0 * slope.x(), 5.0, -5.0 * slope.y());  // The image y axis is down.
        EXPECT_NEAR(image.at(column, row), 255.0 * textured_albedo(point, 0.2, 1.0), 1.0)
            << column << " " << row;
      }
    }
  }
}

TEST(SimulatedPhoto, HasShadowsGroundAndSky) {
  const Scene scene(wall_at(5.0));
  const geometry::PhotoCamera camera(small_camera());
  PhotoOptions options{.gsd = 0.2, .contrast = 0.0, .ground = -1.0, .noise = 0.0};
  options.to_sun = {0, 1, 0};  // The sun is behind the wall, which is then half as bright.
  const GreyImage wall = simulate_photo(scene, camera, {{0, 0, 0}, Vector3d::UnitY()}, options);
  EXPECT_EQ(wall.at(40, 30), 64);
  const GreyImage sky = simulate_photo(scene, camera, {{0, 0, 0}, -Vector3d::UnitY()}, options);
  EXPECT_EQ(sky.at(40, 5), 191);
  options.to_sun = {0, 0, 1};
  const GreyImage ground = simulate_photo(scene, camera, {{0, 0, 0}, -Vector3d::UnitZ()}, options);
  EXPECT_EQ(ground.at(40, 55), 96);
}

// Motion blur: the camera moves over several features of the texture.
TEST(SimulatedPhoto, IsBlurredByMotion) {
  const Scene scene(wall_at(5.0));
  const geometry::PhotoCamera camera(small_camera());
  PhotoOptions options{.gsd = 0.1, .noise = 0.0, .samples_per_side = 4};
  const geometry::View view{{0, 0, 0}, Vector3d::UnitY()};
  const auto variance = [&] {
    const GreyImage image = simulate_photo(scene, camera, view, options);
    double sum = 0.0, squares = 0.0;
    for (const std::uint8_t grey : image.pixels) sum += grey, squares += double(grey) * grey;
    const double mean = sum / static_cast<double>(image.pixels.size());
    return squares / static_cast<double>(image.pixels.size()) - mean * mean;
  };
  const double sharp = variance();
  options.motion = {1.0, 0, 0};
  EXPECT_LT(variance(), 0.8 * sharp);
}

TEST(SimulatedPhoto, IsSameForAnyThreadCount) {
  const Scene scene(wall_at(5.0));
  const geometry::PhotoCamera camera(small_camera());
  const geometry::View view{{0.3, 0, 0.1}, Vector3d(0.1, 1, -0.2).normalized()};
  PhotoOptions options{.threads = 1};
  const GreyImage one = simulate_photo(scene, camera, view, options);
  options.threads = 3;
  EXPECT_EQ(one.pixels, simulate_photo(scene, camera, view, options).pixels);
  options.seed = 2;
  EXPECT_NE(one.pixels, simulate_photo(scene, camera, view, options).pixels);
  options.gsd = 0.0;
  EXPECT_THAT(testing_support::thrown_message([&] { options.validate(); }),
              testing::HasSubstr("gsd is 0"));
}

}  // namespace
}  // namespace skycap::sim
