#include "flight/motion/image_motion_bounds.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace skycap::flight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

geometry::Camera wide_camera() {
  geometry::CameraConfig config;
  config.width = 1600;
  config.height = 1200;
  config.horizontal_fov = 1.4;
  config.vertical_fov = 1.1;
  return geometry::Camera(config);
}

// At the image centre, 0.2 m/s at 10 m and 0.03 rad/s rotate the line of sight by 0.05 rad/s.
TEST(ImageMotionBounds, MatchClosedFormForNarrowCamera) {
  geometry::CameraConfig config;
  config.width = 1000;
  config.height = 1000;
  config.horizontal_fov = config.vertical_fov = 0.002;
  const geometry::Camera camera(config);
  const Vehicle vehicle{.sway_speed = 0.2, .sway_rate = 0.03};
  const ImageMotionBounds bounds = image_motion_bounds(vehicle, camera, {0.001, 0.02}, 10.0);
  const double focal = 500.0 / std::tan(0.001);
  EXPECT_NEAR(bounds.blur_px, focal * 0.05 * 0.001, 1e-4 * bounds.blur_px);
  EXPECT_NEAR(bounds.shear_px, focal * 0.05 * 0.02, 1e-4 * bounds.shear_px);
  EXPECT_EQ(bounds.distance, 10.0);
}

// Random small motions of this magnitude stay within the bound, and some come close to it.
TEST(ImageMotionBounds, BoundRandomMotionsAtAllCorners) {
  const geometry::Camera camera = wide_camera();
  const Vehicle vehicle{.sway_speed = 0.1, .sway_rate = 0.02};
  constexpr double exposure = 0.01, distance = 8.0;
  const double bound = image_motion_bounds(vehicle, camera, {exposure, 0.0}, distance).blur_px;
  const Vector2d focal = camera.focal_length_px();
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    return Vector3d{normal(random), normal(random), normal(random)}.normalized();
  };
  double largest = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double x = (i & 1 ? 0.5 : -0.5) * camera.width() / focal.x();
    const double y = (i & 2 ? 0.5 : -0.5) * camera.height() / focal.y();
    const Vector3d before = distance * Vector3d(x, y, 1.0);
    const Eigen::AngleAxisd turn(vehicle.sway_rate * exposure, direction());
    const Vector3d after = turn * before + vehicle.sway_speed * exposure * direction();
    const Vector2d moved(focal.x() * (after.x() / after.z() - x),
                         focal.y() * (after.y() / after.z() - y));
    largest = std::max(largest, moved.norm());
  }
  EXPECT_LE(largest, bound * (1.0 + 1e-3));  // first-order approximation
  EXPECT_GE(largest, 0.6 * bound);
}

// At this speed the image moves by one pixel during the exposure, or between the first and the last
// row.
TEST(ImageMotionBounds, AreOnePixelAtSharpSpeed) {
  const geometry::Camera camera = wide_camera();
  Vehicle vehicle{.sway_speed = 0.1, .sway_rate = 0.002};
  for (const geometry::Shutter& shutter :
       {geometry::Shutter{0.002, 0.0}, geometry::Shutter{0.001, 0.004}}) {
    const double speed = sharp_speed(vehicle, camera, shutter, 12.0);
    ASSERT_GT(speed, 0.5);
    Vehicle moving = vehicle;
    moving.sway_speed += speed;
    const ImageMotionBounds bounds = image_motion_bounds(moving, camera, shutter, 12.0);
    EXPECT_NEAR(std::max(bounds.blur_px, bounds.shear_px), ImageMotionBounds::sharp_px, 1e-9);
  }
  EXPECT_TRUE(std::isinf(sharp_speed(vehicle, camera, {0.0, 0.0}, 12.0)));
  EXPECT_EQ(sharp_speed(vehicle, camera, {10.0, 0.0}, 12.0), 0.0) << "not even at rest";
}

TEST(ImageMotionBounds, AreSharpUpToOnePixel) {
  EXPECT_TRUE((ImageMotionBounds{1.0, 0.0, 5.0}).is_sharp());
  EXPECT_FALSE((ImageMotionBounds{1.01, 0.0, 5.0}).is_sharp());
  EXPECT_FALSE((ImageMotionBounds{0.0, 1.01, 5.0}).is_sharp());
}

}  // namespace
}  // namespace skycap::flight
