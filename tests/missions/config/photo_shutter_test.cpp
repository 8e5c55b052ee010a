#include "missions/config/photo_shutter.h"

#include <gtest/gtest.h>

#include "tests/missions/photo/test_plan.h"

namespace skycap::missions::config {
namespace {

// Values from DJI's table. The P1 must not have the number of the H20, a common mistake.
TEST(WpmlPayload, IsThatOfTheCamera) {
  EXPECT_EQ(wpml_payload("zenmuse_p1_35"), 50);
  EXPECT_EQ(wpml_payload("dji_zenmuse_p1"), 50);
  EXPECT_EQ(wpml_payload("zenmuse_h20t"), 43);
  EXPECT_EQ(wpml_payload("mavic_3e_wide"), 66);
  EXPECT_EQ(wpml_payload("m30_wide"), 52);
  EXPECT_EQ(wpml_payload("m30t_wide"), 53);
  EXPECT_EQ(wpml_payload("matrice_4e_wide"), 88);
  EXPECT_EQ(wpml_payload("sony_a7r_iv_35"), std::nullopt);
  EXPECT_EQ(wpml_payload("mavic_3"), std::nullopt);
}

TEST(PhotoShutter, FollowsFromTheDataSheet) {
  geometry::PhotoCameraConfig camera = photo::mavic_3e();
  const flight::PhotoShutter shutter = make_photo_shutter(camera, 0.005);
  EXPECT_EQ(shutter.gsd, 0.005);
  EXPECT_EQ(shutter.exposure, 0.001);
  EXPECT_EQ(shutter.min_interval, 0.7);
  EXPECT_EQ(shutter.payload, 66);
  EXPECT_EQ(shutter.image_format, "visable");
  camera.formats = {"wide"};
  EXPECT_EQ(make_photo_shutter(camera, 0.005).image_format, "wide");
}

}  // namespace
}  // namespace skycap::missions::config
