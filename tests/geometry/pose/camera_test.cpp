#include "geometry/pose/camera.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;

const Camera camera{CameraConfig{.width = 101,
                                 .height = 51,
                                 .horizontal_fov = 1.0,
                                 .vertical_fov = 0.7,
                                 .min_range = 0.3,
                                 .max_range = 20.0}};

TEST(Camera, ProjectsOpticalAxisToImageCentre) {
  const auto pixel = camera.project({0.0, 0.0, 5.0});
  ASSERT_TRUE(pixel);
  EXPECT_TRUE(pixel->isApprox(Vector2d(50.0, 25.0)));
}

// Property: projecting any point on a pixel's ray gives that pixel back.
TEST(Camera, InvertsProjectionByRay) {
  for (int u = 0; u <= 100; u += 10) {
    for (int v = 0; v <= 50; v += 10) {
      const auto pixel = camera.project(7.0 * camera.ray({u, v}));
      ASSERT_TRUE(pixel) << "pixel " << u << ", " << v;
      EXPECT_NEAR((*pixel - Vector2d(u, v)).norm(), 0.0, 1e-9) << "pixel " << u << ", " << v;
    }
  }
}

// The outer edges of the outermost pixels subtend the angles of view.
TEST(Camera, HasFrustumOfFieldOfView) {
  const double just_inside = std::tan(0.5 - 1e-6), just_outside = std::tan(0.5 + 1e-6);
  EXPECT_TRUE(camera.project(Vector3d(-just_inside, 0, 1)));
  EXPECT_FALSE(camera.project(Vector3d(-just_outside, 0, 1)));
  EXPECT_TRUE(camera.project(Vector3d(0, -std::tan(0.35 - 1e-6), 1)));
  EXPECT_FALSE(camera.project(Vector3d(0, -std::tan(0.35 + 1e-6), 1)));
}

TEST(Camera, RejectsPointsBehindTooNearTooFarAndNan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(camera.project({0, 0, -5}));
  EXPECT_FALSE(camera.project({0, 0, 0.29}));
  EXPECT_FALSE(camera.project({0, 0, 20.1}));
  EXPECT_FALSE(camera.project({nan, 0, 5}));
  EXPECT_FALSE(camera.project({0, 0, nan}));
}

TEST(Camera, RejectsFieldOfViewOf180Degrees) {
  const CameraConfig config{.horizontal_fov = 3.1416};
  try {
    config.validate();
    FAIL() << "accepted a field of view of " << config.horizontal_fov << " rad";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_config);
    EXPECT_THAT(error.what(), HasSubstr("horizontal_fov"));
  }
}

// Known values: the paper's formula with its published settings (spec see.md §1.3).
TEST(ViewDistance, MatchesPublishedSettings) {
  const Camera d435(CameraConfig{});
  EXPECT_NEAR(view_distance(d435, 146'000), 1.980, 5e-4);
  EXPECT_NEAR(view_distance(d435, 1e6), 1.043, 5e-4);
  const Camera high_resolution(CameraConfig{
      .width = 2400, .height = 1750, .horizontal_fov = 60 * degree, .vertical_fov = 40 * degree});
  EXPECT_NEAR(view_distance(high_resolution, 213), 41.29, 5e-3);
}

}  // namespace
}  // namespace skycap::geometry
