// Rawlogs that are incomplete, damaged, or declare wrong sizes.
#include <cmath>
#include <cstring>
#include <functional>
#include <string_view>
#include <utility>

#include <gmock/gmock.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CSensoryFrame.h>

#include "tests/missions/online/recordings/written_rawlog.h"

namespace skycap::missions::online {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(Rawlog, RejectsMissingPosesScansOrSensorChoice) {
  EXPECT_THAT(
      error_message(write({range_scan(1.0), std::make_shared<mrpt::obs::CObservationGPS>()})),
      AllOf(HasSubstr("x.rawlog: contains no poses of its scans"), HasSubstr("--poses")));
  EXPECT_THAT(error_message(write({robot_pose(1.0, {})})), HasSubstr("contains no usable scan"));
  const std::string two = write({robot_pose(1.0, {}), range_scan(1.0, "L"), range_scan(1.0, "R")});
  EXPECT_THAT(error_message(two), AllOf(HasSubstr("'L', 'R'"), HasSubstr("--sensor")));
  EXPECT_THAT(error_message(two, {.sensor = "M", .poses = {}}),
              HasSubstr("'M'; its sensors are 'L', 'R'"));
  EXPECT_EQ(frames(two, {.sensor = "R", .poses = {}}).at(0).id, "R 2");
}

TEST_F(Rawlog, ReportsInvalidIntrinsicsAndRangeUnits) {
  const auto note = [&](const std::function<void(CObservation3DRangeScan&)>& corrupt) {
    const auto scan = range_scan(1.0);
    corrupt(*scan);
    EXPECT_THAT(frames(write({robot_pose(1.0, {}), scan})), IsEmpty());
    return notes_.at(0);
  };
  EXPECT_THAT(note([](auto& scan) { scan.cameraParams.fx(0.0); }),
              HasSubstr("missing focal length"));
  EXPECT_THAT(note([](auto& scan) { scan.cameraParams.cx(NAN); }), HasSubstr("principal point"));
  EXPECT_THAT(note([](auto& scan) { scan.rangeUnits = 0.0F; }), HasSubstr("the depth unit"));
  EXPECT_THAT(note([](auto& scan) { scan.hasRangeImage = false; }), HasSubstr("neither"));
  EXPECT_THAT(note([](auto& scan) {
                scan.cameraParams.distortion = mrpt::img::DistortionModel::kannala_brandt;
              }),
              HasSubstr("fisheye"));
  EXPECT_THAT(note([](auto& scan) {
                scan.cameraParams.distortion = mrpt::img::DistortionModel::plumb_bob;
                scan.cameraParams.dist[6] = 0.1;
              }),
              HasSubstr("other than k1 k2"));
  EXPECT_THAT(note([](auto& scan) { scan.sensorPose.x(1e30); }), HasSubstr("its pose"));
}

/// Well-compressed content is small in the file.
TEST_F(Rawlog, RejectsContentBeyondMemoryLimits) {
  const auto large = range_scan(1.0);
  large->rangeImage_setSize(5001, 5000);
  large->rangeImage.setZero();
  const auto scattered = range_scan(1.0);
  scattered->hasRangeImage = false;
  scattered->hasPoints3D = true;
  scattered->resizePoints3DVectors(25'000'001);
  for (const auto& [scan, what] : {std::pair(large, "pixels"), std::pair(scattered, "points")}) {
    EXPECT_THAT(frames(write({robot_pose(1.0, {}), scan}, "x.rawlog.gz")), IsEmpty());
    EXPECT_THAT(notes_.at(0), AllOf(HasSubstr("more than 25 million"), HasSubstr(what)));
  }
  Objects sensors{robot_pose(1.0, {})};
  for (int i = 0; i <= 64; ++i) sensors.push_back(range_scan(1.0, std::to_string(i)));
  EXPECT_THAT(error_message(write(sensors)), HasSubstr("more than 64 sensors"));
  EXPECT_THAT(error_message(write({range_scan(1.0, std::string(257, 'x'))})),
              HasSubstr("more than 256 bytes"));
}

TEST_F(Rawlog, RejectsTruncatedFiles) {
  for (const std::string name : {"x.rawlog", "x.rawlog.gz"}) {
    const std::string whole =
        tests::read_content(write({robot_pose(1.0, {}), range_scan(1.0)}, name));
    for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 50) {
      const std::string what = error_message(folder_.write("cut_" + name, whole.substr(0, size)));
      EXPECT_THAT(what, HasSubstr("cut_" + name)) << size;
    }
  }
  EXPECT_THAT(error_message(folder_.write("text.rawlog", "this is a text and no rawlog at all")),
              HasSubstr("text.rawlog: entry 0 cannot be read"));
  EXPECT_THAT(error_message(folder_ / "nowhere.rawlog"), HasSubstr("is not a file"));
}

/// MRPT allocates what a file declares: a number of points, and the sides of an image.
TEST_F(Rawlog, RejectsInvalidCounts) {
  const std::string whole = tests::read_content(write({robot_pose(1.0, {}), range_scan(1.0)}));
  const std::string sides{"\x18\0\0\0\x20\0\0\0", 8};
  const std::size_t at = whole.find(sides);
  ASSERT_NE(at, std::string::npos);
  for (const auto& [rows, columns] : {std::pair(0xffffffffU, 0xffffffffU),
                                      {0x80000000U, 2U},
                                      {0x10000U, 0x10000U},
                                      {0x7fffffffU, 0x7fffffffU},
                                      {24U, 0xffffffffU},
                                      {0x7fffffffU, 1U},
                                      {25U, 32U}}) {
    std::string hostile = whole;
    std::memcpy(&hostile[at], &rows, 4);
    std::memcpy(&hostile[at + 4], &columns, 4);
    EXPECT_THAT(error_message(folder_.write("hostile.rawlog", hostile)),
                HasSubstr("hostile.rawlog"))
        << rows << " x " << columns;
  }
}

TEST_F(Rawlog, ReadsOrRejectsDamagedFiles) {
  auto frame = std::make_shared<mrpt::obs::CSensoryFrame>();
  frame->insert(range_scan(1.0));
  const std::string whole = tests::read_content(
      write({robot_pose(1.0, {}), wheels(1.0, 0, 0), range_scan(1.0, "DEPTH"), frame}));
  std::mt19937_64 random(1);
  // Bytes of image pixels are not tested.
  std::vector<std::size_t> offsets;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const bool is_pixel = std::string_view(whole).substr(i, 3).find('\0') == std::string::npos;
    if (!is_pixel || i < 1000) offsets.push_back(i);
  }
  std::size_t rejected = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::string damaged = whole;
    for (std::uint64_t count = 1 + random() % 3; count > 0; --count) {
      damaged[offsets[random() % offsets.size()]] = static_cast<char>(random());
    }
    rejected += error_message(folder_.write("damaged.rawlog", damaged)).empty() ? 0 : 1;
  }
  EXPECT_GT(rejected, 20U);
}

}  // namespace
}  // namespace skycap::missions::online
