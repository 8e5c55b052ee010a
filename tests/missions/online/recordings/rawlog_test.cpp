// Rawlogs written by MRPT's library, and the positions of their points.
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <sstream>

#include <gmock/gmock.h>
#include <mrpt/io/lazy_load_path.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/CSensoryFrame.h>

#include "geometry/points/depth_image.h"
#include "tests/missions/online/recordings/written_rawlog.h"

namespace skycap::missions::online {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// Returns the pose of the optical frame, by MRPT's composition.
CPose3D optical(const CPose3D& sensor) {
  constexpr double quarter = 0.5 * std::numbers::pi;
  return sensor + CPose3D(0, 0, 0, -quarter, 0, -quarter);
}

bool is_near(const Isometry3d& pose, const CPose3D& expected) {
  const Eigen::Matrix4d matrix =
      expected.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>().asEigen();
  return (pose.matrix() - matrix).norm() < 1e-9;
}

TEST_F(Rawlog, ProjectsRangeImagesLikeMrpt) {
  const CPose3D robot(1.0, 2.0, 3.0, -0.5, 0.1, 0.3);
  for (const bool is_depth : {true, false}) {
    for (const bool is_bent : {true, false}) {
      const auto scan = range_scan(7.0);
      scan->range_is_depth = is_depth;
      if (is_bent) {
        scan->cameraParams.distortion = mrpt::img::DistortionModel::plumb_bob;
        scan->cameraParams.dist = {0.1, -0.05, 0.002, -0.001, 0.01, 0, 0, 0};
      }
      const auto all = frames(write({robot_pose(7.0, robot), scan}));
      ASSERT_EQ(all.size(), 1U);
      mrpt::obs::T3DPointsProjectionParams where;
      where.takeIntoAccountSensorPoseOnRobot = true;
      where.robotPoseInTheWorld = robot;
      mrpt::maps::CSimplePointsMap expected;
      scan->unprojectInto(expected, where);
      const std::vector<Eigen::Vector3f> found = points(all[0]);
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        Eigen::Vector3f point;
        expected.getPoint(i, point.x(), point.y(), point.z());
        // MRPT's rays are floats and undistorted with few iterations, which limits the accuracy to
        // a thousandth of a pixel.
        ASSERT_LT((found[i] - point).norm(), 5e-4) << i << ", " << is_depth << ", " << is_bent;
      }
    }
  }
}

TEST_F(Rawlog, UsesPosesNearestInTime) {
  const auto all =
      frames(write({robot_pose(1.0, {1, 0, 0, 0, 0, 0}), range_scan(1.01), wheels(1.01, 9, 0),
                    range_scan(1.5), range_scan(1.99), robot_pose(2.0, {2, 0, 0, 0.5, 0, 0})}));
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].id, "DEPTH 1");
  EXPECT_EQ(all[1].id, "DEPTH 4");
  EXPECT_TRUE(is_near(all[0].world_from_sensor, optical(CPose3D(1, 0, 0) + mount)));
  EXPECT_TRUE(is_near(all[1].world_from_sensor, optical(CPose3D(2, 0, 0, 0.5, 0, 0) + mount)));
  EXPECT_THAT(notes_, ElementsAre(AllOf(StartsWith("DEPTH 3 is skipped"), HasSubstr("20 ms"))));
  EXPECT_THAT(source_, HasSubstr("CObservationRobotPose"));
  EXPECT_THAT(reports_, ElementsAre(HasSubstr("scan 1"), HasSubstr("scan 2"), HasSubstr("scan 3")));
}

TEST_F(Rawlog, UsesWheelOdometryWithoutBetterPoses) {
  const auto all = frames(write({wheels(1.0, 2.0, 0.5), range_scan(1.0)}));
  ASSERT_EQ(all.size(), 1U);
  EXPECT_TRUE(is_near(all[0].world_from_sensor, optical(CPose3D(2, 0, 0, 0.5, 0, 0) + mount)));
  EXPECT_THAT(source_, HasSubstr("with drift"));
}

/// The older format alternates frames of observations with movements of the robot.
TEST_F(Rawlog, IntegratesMovementsBetweenFrames) {
  const CPose3D in_space(0.5, 0.1, 0.2, 0.3, 0.1, -0.1);
  const auto frame = [](double time) {
    auto all = std::make_shared<mrpt::obs::CSensoryFrame>();
    all->insert(range_scan(time));
    return all;
  };
  mrpt::obs::CActionRobotMovement2D planar;
  planar.computeFromOdometry(mrpt::poses::CPose2D(1.0, 0.0, 0.4), {});
  mrpt::obs::CActionRobotMovement3D spatial;
  spatial.poseChange.mean = in_space;
  const auto first = std::make_shared<mrpt::obs::CActionCollection>();
  first->insert(planar);
  const auto second = std::make_shared<mrpt::obs::CActionCollection>();
  second->insert(spatial);
  for (const std::string name : {"x.rawlog", "x.rawlog.gz"}) {
    const auto all = frames(write({first, frame(1.0), second, frame(2.0)}, name));
    ASSERT_EQ(all.size(), 2U);
    const CPose3D start(1.0, 0.0, 0.0, 0.4, 0, 0);
    EXPECT_TRUE(is_near(all[0].world_from_sensor, optical(start + mount)));
    EXPECT_TRUE(is_near(all[1].world_from_sensor, optical(start + in_space + mount)));
    EXPECT_THAT(source_, HasSubstr("movements"));
  }
}

TEST_F(Rawlog, ReadsTrajectoryPosesAsOpticalFrames) {
  const std::string poses = folder_.write("poses.txt", "# t x y z q\n4.99 1 2 3 0 0 0 1\n");
  const auto all = frames(write({robot_pose(5.0, {9, 9, 9, 0, 0, 0}), range_scan(5.0)}),
                          {.sensor = "", .poses = poses});
  ASSERT_EQ(all.size(), 1U);
  Isometry3d expected = Isometry3d::Identity();
  expected.translation() = Vector3d(1, 2, 3);
  EXPECT_TRUE(all[0].world_from_sensor.isApprox(expected));
  EXPECT_THAT(error_message(write({range_scan(5.0)}), {.sensor = "", .poses = folder_ / "none"}),
              HasSubstr("none"));
}

TEST_F(Rawlog, ReadsExternalImageFiles) {
  const std::string images = folder_ / "x_Images";
  std::filesystem::create_directories(images);
  const auto pose = robot_pose(1.0, {});
  const auto outside = [&](const std::string& name) {
    const auto scan = range_scan(1.0);
    mrpt::io::setLazyLoadPathBase(images);
    scan->rangeImage_convertToExternalStorage(name, images);
    return write({pose, scan});
  };
  const auto kept = frames(write({pose, range_scan(1.0)}));
  const auto found = frames(outside("image.bin"));
  ASSERT_EQ(found.size(), 1U) << testing::PrintToString(notes_);
  EXPECT_TRUE(points(found[0]) == points(kept[0]));
  std::filesystem::remove(images + "/image.bin");
  EXPECT_THAT(frames(folder_ / "x.rawlog"), IsEmpty());
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("'image.bin', which does not exist")));
  EXPECT_THAT(frames(outside("../image.bin")), IsEmpty());
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("outside the rawlog's folder")));
}

TEST_F(Rawlog, ReadsPointClouds) {
  const auto cloud = std::make_shared<mrpt::obs::CObservationPointCloud>();
  cloud->timestamp = mrpt::Clock::fromDouble(1.0);
  cloud->sensorPose = mount;
  const auto map = mrpt::maps::CSimplePointsMap::Create();
  map->insertPoint(4.0F, 1.0F, -2.0F);
  map->insertPoint(NAN, 1.0F, -2.0F);
  cloud->pointcloud = map;
  const CPose3D robot(1.0, 2.0, 3.0, -0.5, 0.1, 0.3);
  const auto found = points(frames(write({robot_pose(1.0, robot), cloud})).at(0));
  ASSERT_EQ(found.size(), 1U);
  const mrpt::math::TPoint3D expected =
      (robot + mount).composePoint(mrpt::math::TPoint3D(4.0, 1.0, -2.0));
  EXPECT_LT((found[0] - Eigen::Vector3d(expected.x, expected.y, expected.z).cast<float>()).norm(),
            1e-5);
}

/// A pulse of a VLP-16's first channel, 15 degrees down, with a range of 5000 steps of 2 mm.
TEST_F(Rawlog, DecodesVelodynePackets) {
  const auto scan = std::make_shared<mrpt::obs::CObservationVelodyneScan>();
  scan->timestamp = mrpt::Clock::fromDouble(1.0);
  scan->calibration = mrpt::obs::VelodyneCalibration::LoadDefaultCalibration("VLP16");
  scan->maxRange = 100.0;
  std::array<std::uint8_t, sizeof(mrpt::obs::CObservationVelodyneScan::TVelodyneRawPacket)> bytes{};
  for (std::size_t block = 0; block < 12; ++block) {
    bytes[100 * block] = 0xff;
    bytes[100 * block + 1] = 0xee;
  }
  bytes[4] = 5000 % 256, bytes[5] = 5000 / 256;
  bytes[1204] = 0x37, bytes[1205] = 0x22;
  scan->scan_packets.resize(1);
  std::memcpy(scan->scan_packets.data(), bytes.data(), bytes.size());
  const auto all = frames(write({robot_pose(1.0, {}), scan}));
  ASSERT_EQ(all.size(), 1U);
  const auto& found = std::get<std::vector<Eigen::Vector3f>>(all[0].scan.content);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].norm(), 10.0, 0.01);
  // y points down.
  EXPECT_NEAR(found[0].y(), 10.0 * std::sin(15.0 * std::numbers::pi / 180.0), 0.02);
}

/// The same images from a rawlog and from PNG files.
TEST_F(Rawlog, MatchesSurveyFromImageFiles) {
  const std::string mission = folder_.write(
      "m.yaml",
      "sensor: {width: 32, height: 24, horizontal_fov_deg: 56.5, vertical_fov_deg: 43.5,\n"
      "         max_range: 8}\n"
      "planner: {density: 100, resolution_radius: 0.4,\n"
      "          scene_box: {min: [-6, -6, -6], max: [6, 6, 6]}}\n"
      "evaluation: {coverage_distance: 0.1}\n"
      "live: {pose_check: false}\n");
  const std::string rawlog =
      write({robot_pose(1.0, {}), range_scan(1.0), robot_pose(2.0, {}), range_scan(2.0)});
  const auto next = [&](const std::string& survey, const std::vector<std::string>& more) {
    std::vector<std::string> all{"next", mission, "--survey", folder_ / survey};
    all.insert(all.end(), more.begin(), more.end());
    return tests::run_skycap(all);
  };
  const tests::ProgramRun all = next("all", {"--dataset", rawlog});
  EXPECT_THAT(all.err, AllOf(HasSubstr("poses from its CObservationRobotPose"),
                             HasSubstr("DEPTH 1: "), HasSubstr("DEPTH 3: ")));
  EXPECT_THAT(next("all", {"--dataset", rawlog}).err, testing::Not(HasSubstr("points")));
  for (const double time : {1.0, 2.0}) {
    const auto scan = range_scan(time);
    const geometry::DepthImage image{
        32, 24, {scan->rangeImage.data(), scan->rangeImage.data() + scan->rangeImage.size()}};
    geometry::write_depth_png(image, folder_.path() / "image.png");
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> pose =
        optical(mount).getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>().asEigen();
    std::ostringstream text;
    text.precision(17);
    for (int i = 0; i < 16; ++i) text << pose.data()[i] << " ";
    EXPECT_LE(next("one", {"--scan", folder_ / "image.png", "--pose", text.str(), "--intrinsics",
                           "30 31 15.2 12.1", "--depth-unit", "0.0005"})
                  .exit_code,
              11);
  }
  for (const char* name : {"scans/000000.ply", "scans/000001.ply"}) {
    const std::string one = tests::read_content(folder_.path() / "one" / name);
    EXPECT_EQ(tests::read_content(folder_.path() / "all" / name).size(), one.size());
    EXPECT_GT(one.size(), 5000U);
  }
}

}  // namespace
}  // namespace skycap::missions::online
