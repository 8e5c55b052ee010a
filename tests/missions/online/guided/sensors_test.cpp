#include "missions/online/guided/sensors.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <stop_token>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/config/resolve.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"

namespace skycap::missions::online {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::thrown_message;

class FolderSensor : public testing::Test {
 protected:
  geometry::Scan scan(std::size_t number, double patience = 5.0) {
    const geometry::View view{{1.0, 2.0, 3.0}, {1.0, 0.0, 0.0}};
    return folder_sensor(setup_.flight(), setup_.live, folder_.path(), {}, patience,
                         stop_.get_token())(view, view, number);
  }

  const config::MissionSetup setup_ = config::parse_mission(tests::quick_mission(), "m.yaml");
  const tests::TestFolder folder_;
  std::stop_source stop_;
};

/// A camera that waits for the pose and then writes a scan with one point in front of it.
TEST_F(FolderSensor, WritesPoseAndReadsArrivingScan) {
  std::jthread camera([&](const std::stop_token& stop) {
    while (!stop.stop_requested() && !fs::exists(folder_.path() / "scan-0007.pose")) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::ofstream(folder_ / "whole") << "0 0 0.5\n";
    fs::rename(folder_ / "whole", folder_ / "scan-0007.xyz");
  });
  const geometry::Scan scan = this->scan(7);
  ASSERT_EQ(scan.points.size(), 1U);
  EXPECT_LT((scan.points[0] - Eigen::Vector3f(1.5F, 2.0F, 3.0F)).norm(), 1e-6F);
  const std::string pose = tests::read_content(folder_.path() / "scan-0007.pose");
  EXPECT_EQ(online::parse_pose_text(pose, "pose").translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
}

TEST_F(FolderSensor, RejectsExistingScan) {
  folder_.write("scan-0002.ply", "");
  EXPECT_THAT(thrown_message([&] { scan(2); }), HasSubstr("existed before"));
}

TEST_F(FolderSensor, TimesOutWithoutScan) {
  EXPECT_THAT(thrown_message([&] { scan(3, 0.1); }), HasSubstr("timeout: no scan arrived"));
  stop_.request_stop();
  EXPECT_THAT(thrown_message([&] { scan(4, 600.0); }), HasSubstr("timeout: no scan arrived"));
  EXPECT_THAT(thrown_message([&] {
                folder_sensor(setup_.flight(), setup_.live, folder_.path() / "none", {}, 1.0, {});
              }),
              HasSubstr("is not a folder"));
}

}  // namespace
}  // namespace skycap::missions::online
