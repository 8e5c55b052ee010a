#include "geometry/pose/photo_camera.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/error.h"

namespace skycap::geometry {
namespace {

using testing::HasSubstr;

PhotoCameraConfig mavic_3e() {
  return {.name = "Mavic 3E",
          .focal_length = 12.29e-3,
          .sensor_size = {17.3e-3, 13e-3},
          .width = 5280,
          .height = 3956};
}

std::string validation_error(const PhotoCameraConfig& config) {
  try {
    config.validate();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_config);
    return error.what();
  }
  return "";
}

/// Camera from a data sheet with its ground sampling distance at 10 m.
struct DataSheet {
  double sensor_width, sensor_height;  // mm
  int width, height;
  double focal_length;  // mm
  double gsd;           // mm
};

TEST(PhotoCamera, HasGroundSamplingDistanceOfDataSheet) {
  constexpr DataSheet sheets[] = {
      {17.3, 13, 5280, 3956, 12.29, 2.67}, {35.9, 24, 8192, 5460, 24, 1.83},
      {35.9, 24, 8192, 5460, 35, 1.25},    {35.9, 24, 8192, 5460, 50, 0.88},
      {6.4, 4.8, 8000, 6000, 4.4, 1.82},   {9.6, 7.2, 4032, 3024, 6.7, 3.55},
      {13.2, 8.8, 5472, 3648, 8.8, 2.74},  {35.7, 23.8, 9504, 6336, 35, 1.07},
  };
  for (const DataSheet& sheet : sheets) {
    const PhotoCamera camera(
        {.focal_length = 1e-3 * sheet.focal_length,
         .sensor_size = {1e-3 * sheet.sensor_width, 1e-3 * sheet.sensor_height},
         .width = sheet.width,
         .height = sheet.height});
    EXPECT_NEAR(1e3 * camera.gsd(10.0), sheet.gsd, 0.0051) << sheet.focal_length;
    EXPECT_NEAR(camera.distance(camera.gsd(10.0)), 10.0, 1e-12);
  }
}

TEST(PhotoCamera, HasFieldOfViewOfItsFocalLength) {
  const PhotoCamera camera(mavic_3e());
  EXPECT_NEAR(camera.horizontal_fov() * degrees_per_radian, 70.2, 0.1);
  EXPECT_NEAR(camera.vertical_fov() * degrees_per_radian, 55.6, 0.1);
}

TEST(PhotoCamera, ProjectsTheAxisToTheMiddleAndTheBorderOutside) {
  const PhotoCamera camera(mavic_3e());
  const auto middle = camera.project({0.0, 0.0, 5.0});
  ASSERT_TRUE(middle);
  EXPECT_DOUBLE_EQ(middle->x(), 2639.5);
  EXPECT_DOUBLE_EQ(middle->y(), 1977.5);
  const double edge = 0.5 * camera.width() / camera.focal_length_px();
  EXPECT_TRUE(camera.project({0.96 * edge, 0.0, 1.0}, 0.015));
  EXPECT_FALSE(camera.project({0.98 * edge, 0.0, 1.0}, 0.015));
  EXPECT_TRUE(camera.project({0.98 * edge, 0.0, 1.0}));
  EXPECT_FALSE(camera.project({0.0, 0.0, -1.0}));
}

TEST(PhotoCamera, RejectsThe35MillimetreEquivalent) {
  PhotoCameraConfig config = mavic_3e();
  config.focal_length = 24e-3;
  EXPECT_THAT(validation_error(config),
              HasSubstr("focal_length (24 mm) appears to be the 35 mm equivalent"));
  EXPECT_THAT(validation_error(config), HasSubstr("about 12 mm"));
  config.horizontal_fov =
      39.6 * radians_per_degree;  // A lens with an actual focal length of 24 mm.
  EXPECT_EQ(validation_error(config), "");
}

TEST(PhotoCamera, RejectsFieldOfViewThatContradictsFocalLength) {
  PhotoCameraConfig config = mavic_3e();
  config.horizontal_fov = 72.0 * radians_per_degree;
  EXPECT_THAT(validation_error(config), HasSubstr("must agree within 1%"));
  config.horizontal_fov = 70.5 * radians_per_degree;
  EXPECT_EQ(validation_error(config), "");
}

TEST(PhotoCamera, RejectsSizesOfDifferentCrops) {
  PhotoCameraConfig config = mavic_3e();
  config.height = 2970;  // A 16:9 crop of the same sensor.
  EXPECT_THAT(validation_error(config), HasSubstr("must have the same aspect ratio within 2%"));
}

TEST(PhotoCamera, RejectsIntervalAndExposureOfZero) {
  PhotoCameraConfig config = mavic_3e();
  config.min_interval = 0.0;
  EXPECT_THAT(validation_error(config), HasSubstr("min_interval is 0"));
  config = mavic_3e();
  config.exposure = 0.0;
  EXPECT_THAT(validation_error(config), HasSubstr("exposure is 0"));
}

}  // namespace
}  // namespace skycap::geometry
