#include "clients/ros2/sensor_scan.h"

#include <algorithm>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/clients/ros2/sample_messages.h"
#include "tests/support/complaint.h"

namespace skycap::ros2 {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::thrown_message;

constexpr float none = std::numeric_limits<float>::quiet_NaN();
constexpr float far_away = std::numeric_limits<float>::infinity();

TEST(CloudScan, KeepsOnlyValidPoints) {
  const SampleCloud cloud(seconds(1.0),
                          {{1, 2, 3}, {none, 2, 3}, {0, 0, 0}, {1, 2, far_away}, {4, 0, 6}});
  EXPECT_THAT(make_scan(cloud.message, Axes::optical).xyz, ElementsAre(1, 2, 3, 4, 0, 6));
}

/// A point 1 m ahead, 2 m to the left and 3 m up has the optical coordinates x = -2, y = -3, z = 1.
TEST(CloudScan, ConvertsBodyAxesToOpticalAxes) {
  const SampleCloud cloud(seconds(1.0), {{1, 2, 3}});
  EXPECT_THAT(make_scan(cloud.message, Axes::flu).xyz, ElementsAre(-2, -3, 1));
}

/// Two rows of two points, with four padding bytes between the rows.
TEST(CloudScan, ReadsOrganisedCloudRowByRow) {
  SampleCloud cloud(seconds(1.0), {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}});
  cloud.data.insert(cloud.data.begin() + 32, 4, 0xFF);
  cloud.data.insert(cloud.data.end(), 4, 0xFF);
  cloud.attach();
  cloud.message.height = 2;
  cloud.message.width = 2;
  cloud.message.row_step = 36;
  EXPECT_THAT(make_scan(cloud.message, Axes::optical).xyz,
              ElementsAre(1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4));
}

TEST(CloudScan, ReadsBigEndianNumbersAndDoubles) {
  SampleCloud cloud(seconds(1.0), {{1.5F, -2.25F, 3.0F}});
  for (std::size_t i = 0; i < 12; i += 4) {
    std::reverse(cloud.data.begin() + i, cloud.data.begin() + i + 4);
  }
  cloud.message.is_bigendian = true;
  EXPECT_THAT(make_scan(cloud.message, Axes::optical).xyz, ElementsAre(1.5F, -2.25F, 3.0F));

  SampleCloud doubles(seconds(1.0), {{0, 0, 0}, {0, 0, 0}});  // 32 bytes
  const double coordinates[3] = {7.0, -8.5, 9.25};
  std::memcpy(doubles.data.data(), coordinates, sizeof coordinates);
  doubles.message.width = 1;
  doubles.message.point_step = doubles.message.row_step = 32;
  for (std::uint32_t i = 0; i < 3; ++i) {
    doubles.fields[i].offset = 8 * i;
    doubles.fields[i].datatype = 8;
  }
  EXPECT_THAT(make_scan(doubles.message, Axes::optical).xyz, ElementsAre(7.0F, -8.5F, 9.25F));
}

TEST(CloudScan, IsEmptyWhenCloudHasNoPoints) {
  const SampleCloud cloud(seconds(1.0), {});
  EXPECT_THAT(make_scan(cloud.message, Axes::optical).xyz, IsEmpty());
}

struct Corruption {
  const char* error_message;
  std::function<void(SampleCloud&)> corrupt;
};

TEST(CloudScan, RejectsMessagesWithInconsistentSizes) {
  const std::vector<Corruption> corruptions = {
      {"it must have 1 x 64", [](SampleCloud& c) { c.data.pop_back(); }},
      {"it must have 2 x 32",
       [](SampleCloud& c) {
         c.message.height = 2;
         c.message.width = 2;
         c.message.row_step = 32;
         c.data.push_back(0);
       }},
      {"4 times 17 require more", [](SampleCloud& c) { c.message.point_step = 17; }},
      {"points; the maximum is",
       [](SampleCloud& c) { c.message.height = c.message.width = 0xFFFFFFFF; }},
      {"points; the maximum is", [](SampleCloud& c) { c.message.width = 0x80000000; }},
      {"times 16 require more", [](SampleCloud& c) { c.message.width = 0x01000001; }},
      {"it must have 0 x 4294967280",
       [](SampleCloud& c) {
         c.message.height = 0;
         c.message.row_step = 0xFFFFFFF0;
       }},
      {"field z ends at byte 17 of points of 16", [](SampleCloud& c) { c.fields[2].offset = 13; }},
      {"field x ends at byte 4294967299", [](SampleCloud& c) { c.fields[0].offset = 0xFFFFFFFF; }},
      {"field y has the type 2", [](SampleCloud& c) { c.fields[1].datatype = 2; }},
      {"field y has more than one value", [](SampleCloud& c) { c.fields[1].count = 3; }},
      {"field x is listed twice", [](SampleCloud& c) { c.fields.push_back(c.fields[0]); }},
      {"missing field z", [](SampleCloud& c) { c.fields.pop_back(); }},
      {"missing field x", [](SampleCloud& c) { c.fields[0].name = nullptr; }},
      {"missing field x", [](SampleCloud& c) { c.fields.clear(); }},
  };
  for (const Corruption& corruption : corruptions) {
    SampleCloud cloud(seconds(1.0), {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}});
    corruption.corrupt(cloud);
    cloud.attach();
    EXPECT_THAT(thrown_message([&] { make_scan(cloud.message, Axes::optical); }),
                HasSubstr(corruption.error_message));
  }
}

TEST(DepthScan, Keeps16UC1ImageWithIntrinsics) {
  const SampleImage image(seconds(1.0), 4,
                          std::vector<std::uint16_t>{0, 1, 2, 3, 400, 500, 600, 65535}, "16UC1");
  const SampleInfo info({0.1, -0.2, 0.001, 0.002, 0.03});
  const auto scan =
      std::get<DepthScan>(make_scan(image.message, to_intrinsics(info.message, false)));
  EXPECT_THAT(scan.depth, ElementsAre(0, 1, 2, 3, 400, 500, 600, 65535));
  EXPECT_EQ(scan.width, 4);
  EXPECT_EQ(scan.height, 2);
  EXPECT_EQ(scan.unit, 0.001);
  EXPECT_THAT(scan.intrinsics, ElementsAre(2, 4, 1.5, 0.5, 0.1, -0.2, 0.001, 0.002, 0.03));
}

/// Pixel (3, 1): x = (3 - 1.5) / 2 * 8, y = (1 - 0.5) / 4 * 8.
TEST(DepthScan, Converts32FC1ImageToCloud) {
  const SampleImage image(seconds(1.0), 4,
                          std::vector<float>{none, 0, -1, far_away, none, none, none, 8}, "32FC1");
  const SampleInfo info;
  const auto scan =
      std::get<CloudScan>(make_scan(image.message, to_intrinsics(info.message, false)));
  EXPECT_THAT(scan.xyz, ElementsAre(6, 1, 8));
}

TEST(DepthScan, UsesProjectionMatrixForRectifiedImages) {
  SampleInfo info({0.1});
  const double p[12] = {3, 0, 1, 0, 0, 5, 2, 0, 0, 0, 1, 0};
  std::memcpy(info.message.p, p, sizeof p);
  EXPECT_THAT(to_intrinsics(info.message, true).intrinsics, ElementsAre(3, 5, 1, 2));
  EXPECT_THAT(to_intrinsics(info.message, false).intrinsics,
              ElementsAre(2, 4, 1.5, 0.5, 0.1, 0, 0, 0, 0));
}

TEST(DepthScan, RejectsImagesWithInconsistentSizes) {
  const SampleInfo info;
  const CameraIntrinsics intrinsics = to_intrinsics(info.message, false);
  const auto error_message = [&](const std::function<void(Image&)>& corrupt) {
    SampleImage image(seconds(1.0), 4, std::vector<std::uint16_t>(8), "16UC1");
    corrupt(image.message);
    return thrown_message([&] { make_scan(image.message, intrinsics); });
  };
  EXPECT_THAT(error_message([](Image& i) { i.step = 7; }), HasSubstr("4 times 2 require more"));
  EXPECT_THAT(error_message([](Image& i) { i.step = 9; }), HasSubstr("it must have 2 x 9"));
  EXPECT_THAT(error_message([](Image& i) { i.data._length = 15; }), HasSubstr("it has 15 bytes"));
  EXPECT_THAT(error_message([](Image& i) { i.width = 0; }), HasSubstr("from 1 to 32768"));
  EXPECT_THAT(error_message([](Image& i) { i.height = 0xFFFFFFFF; }), HasSubstr("from 1 to 32768"));
  EXPECT_THAT(error_message([](Image& i) { i.width = 3; }), HasSubstr("CameraInfo has 4 x 2"));
  EXPECT_THAT(error_message([](Image& i) { i.encoding = nullptr; }), HasSubstr("16UC1 or 32FC1"));
}

TEST(DepthScan, RejectsUnsupportedIntrinsics) {
  const auto error_message = [](const std::function<void(SampleInfo&)>& corrupt,
                                std::vector<double> distortion = {}) {
    SampleInfo info(std::move(distortion));
    corrupt(info);
    return thrown_message([&] { to_intrinsics(info.message, false); });
  };
  const auto nothing = [](SampleInfo&) {};
  EXPECT_THAT(error_message([](SampleInfo& i) { i.message.k[0] = 0; }),
              HasSubstr("invalid focal length or principal point"));
  EXPECT_THAT(error_message([](SampleInfo& i) { i.message.k[2] = none; }),
              HasSubstr("invalid focal length or principal point"));
  EXPECT_THAT(error_message([](SampleInfo& i) { i.message.binning_x = 2; }), HasSubstr("binning"));
  EXPECT_THAT(error_message([](SampleInfo& i) { i.message.roi.width = 2; }), HasSubstr("region"));
  EXPECT_THAT(error_message([](SampleInfo& i) { i.message.roi.y_offset = 1; }),
              HasSubstr("region"));
  EXPECT_THAT(error_message(nothing, {0, 0, 0, 0, 0, 0.1, 0, 0}), HasSubstr("plumb_bob"));
  EXPECT_THAT(error_message(nothing, {none}), HasSubstr("D is not finite"));
  EXPECT_EQ(error_message(nothing, {0, 0, 0, 0, 0, 0, 0, 0}), "");
  std::string fisheye = "equidistant";
  EXPECT_THAT(
      error_message([&](SampleInfo& i) { i.message.distortion_model = fisheye.data(); }, {0.1}),
      HasSubstr("'equidistant' with 1"));
  const SampleInfo distorted({0.1});
  const SampleImage image(seconds(1.0), 4, std::vector<float>(8), "32FC1");
  EXPECT_THAT(
      thrown_message([&] { make_scan(image.message, to_intrinsics(distorted.message, false)); }),
      HasSubstr("rectify"));
}

}  // namespace
}  // namespace skycap::ros2
