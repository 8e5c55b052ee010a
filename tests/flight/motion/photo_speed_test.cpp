// Maximum speeds for image sharpness and for the interval of the camera.
#include "flight/motion/photo_speed.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Calculated by hand: half a GSD during the exposure, one GSD during the readout, one spacing per
// interval.
TEST(PhotoSpeeds, AreLimitedByBlurReadoutTriggerAndVehicle) {
  const PhotoShutter mavic_3e{.gsd = 0.005, .exposure = 0.001, .min_interval = 0.7};
  const PhotoSpeeds speeds = photo_speeds(mavic_3e, 3.3, 8.0);
  EXPECT_NEAR(speeds.blur, 2.5, 1e-12);
  EXPECT_EQ(speeds.rolling_shutter, infinite);
  EXPECT_NEAR(speeds.trigger, 3.3 / 0.7, 1e-12);
  EXPECT_EQ(speeds.vehicle, 8.0);
  EXPECT_NEAR(speeds.min(), 2.5, 1e-12);
  EXPECT_STREQ(speeds.limit(), "motion blur");

  const PhotoShutter rolling{.gsd = 0.005, .exposure = 0.0005, .readout = 0.01, .min_interval = 2};
  EXPECT_NEAR(photo_speeds(rolling, 2.5, 8.0).rolling_shutter, 0.5, 1e-12);
  EXPECT_STREQ(photo_speeds(rolling, 2.5, 8.0).limit(), "rolling shutter");
  EXPECT_STREQ(photo_speeds(mavic_3e, 1.0, 8.0).limit(), "trigger interval");
  EXPECT_STREQ(photo_speeds(mavic_3e, 3.3, 1.0).limit(), "cruise speed");
}

TEST(PhotoShutter, NamesTheFieldThatIsWrong) {
  const auto error_message = [](const PhotoShutter& shutter) {
    return testing_support::thrown_message([&] { shutter.validate(); });
  };
  EXPECT_THAT(error_message({.gsd = 0.0}), testing::HasSubstr("gsd is 0"));
  EXPECT_THAT(error_message({.gsd = 0.01, .exposure = -1.0}), testing::HasSubstr("exposure is -1"));
  EXPECT_THAT(error_message({.gsd = 0.01, .readout = std::nan("")}),
              testing::HasSubstr("readout is"));
  EXPECT_THAT(error_message({.gsd = 0.01, .min_interval = infinite}),
              testing::HasSubstr("min_interval is inf"));
  EXPECT_EQ(error_message({.gsd = 0.01}), "");
}

}  // namespace
}  // namespace skycap::flight
