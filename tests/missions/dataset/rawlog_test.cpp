// Rawlogs that MRPT's own library has written, and put into space.
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/io/lazy_load_path.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include "geometry/error.h"
#include "missions/dataset/rawlog_sequence.h"
#include "missions/derived/resolved_mission.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"

namespace skycap::missions::dataset {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using mrpt::obs::CObservation3DRangeScan;
using mrpt::poses::CPose3D;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing_support::complaint_of;
using Objects = std::vector<mrpt::serialization::CSerializable::Ptr>;

const CPose3D mount(0.3, -0.2, 0.1, 0.4, -0.3, 0.2);

/// An image of 32 x 24 pixels, a fifth of them without a return.
std::shared_ptr<CObservation3DRangeScan> range_scan(double time,
                                                    const std::string& label = "DEPTH") {
  auto scan = std::make_shared<CObservation3DRangeScan>();
  scan->timestamp = mrpt::Clock::fromDouble(time);
  scan->sensorLabel = label;
  scan->sensorPose = mount;
  scan->hasRangeImage = true;
  scan->rangeUnits = 0.0005F;
  scan->rangeImage_setSize(24, 32);
  scan->cameraParams.ncols = 32;
  scan->cameraParams.nrows = 24;
  scan->cameraParams.setIntrinsicParamsFromValues(30.0, 31.0, 15.2, 12.1);
  std::mt19937_64 random(static_cast<std::uint64_t>(1000 * time));
  for (int row = 0; row < 24; ++row) {
    for (int column = 0; column < 32; ++column) {
      const std::uint64_t number = random();
      scan->rangeImage(row, column) =
          number % 5 == 0 ? 0 : static_cast<std::uint16_t>(2000 + number % 9000);
    }
  }
  return scan;
}

auto robot_pose(double time, const CPose3D& pose) {
  auto observation = std::make_shared<mrpt::obs::CObservationRobotPose>();
  observation->timestamp = mrpt::Clock::fromDouble(time);
  observation->sensorLabel = "POSE";
  observation->pose.mean = pose;
  return observation;
}

auto wheels(double time, double x, double heading) {
  auto observation = std::make_shared<mrpt::obs::CObservationOdometry>();
  observation->timestamp = mrpt::Clock::fromDouble(time);
  observation->odometry = mrpt::poses::CPose2D(x, 0.0, heading);
  return observation;
}

/// With the axes of the optical frame, by MRPT's own composition.
CPose3D optical(const CPose3D& sensor) {
  constexpr double quarter = 0.5 * std::numbers::pi;
  return sensor + CPose3D(0, 0, 0, -quarter, 0, -quarter);
}

bool is_near(const Isometry3d& pose, const CPose3D& expected) {
  const Eigen::Matrix4d matrix =
      expected.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>().asEigen();
  return (pose.matrix() - matrix).norm() < 1e-9;
}

class Rawlog : public testing::Test {
 protected:
  std::string write(const Objects& objects, const std::string& name = "x.rawlog") const {
    const std::string file = folder_ / name;
    const auto write_to = [&](auto stream) {
      auto archive = mrpt::serialization::archiveFrom(stream);
      for (const auto& object : objects) archive << *object;
    };
    if (name.ends_with(".gz")) {
      write_to(mrpt::io::CFileGZOutputStream(file));
    } else {
      write_to(mrpt::io::CFileOutputStream(file));
    }
    return file;
  }

  std::vector<RawlogFrame> frames(const std::string& file, const RawlogChoice& choice = {}) {
    notes_.clear();
    RawlogSequence sequence(file, choice, [&](const std::string& note) { notes_.push_back(note); });
    source_ = sequence.pose_source();
    std::vector<RawlogFrame> all;
    while (auto frame = sequence.next()) all.push_back(std::move(*frame));
    return all;
  }

  std::string complaint(const std::string& file, const RawlogChoice& choice = {}) {
    const std::string what = complaint_of([&] { frames(file, choice); });
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
  }

  /// The scan as of a mission that takes all points in.
  static std::vector<Eigen::Vector3f> points(const RawlogFrame& frame) {
    file::Mission mission;
    mission.sensor.scanner = sim::LidarConfig{};
    return scan_of(frame, mission).scan.points;
  }

  tests::TestFolder folder_;
  std::vector<std::string> notes_;
  std::string source_;
};

TEST_F(Rawlog, RangeImagesAreWhereMrptPutsThem) {
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
        // MRPT's rays are floats, and undistorted in few rounds: a thousandth of a pixel.
        ASSERT_LT((found[i] - point).norm(), 5e-4) << i << ", " << is_depth << ", " << is_bent;
      }
    }
  }
}

TEST_F(Rawlog, PosesAreThoseNearestInTime) {
  const auto all =
      frames(write({robot_pose(1.0, {1, 0, 0, 0, 0, 0}), range_scan(1.01), wheels(1.01, 9, 0),
                    range_scan(1.5), range_scan(1.99), robot_pose(2.0, {2, 0, 0, 0.5, 0, 0})}));
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].id, "DEPTH 1");
  EXPECT_EQ(all[1].id, "DEPTH 4");
  EXPECT_TRUE(is_near(all[0].world_from_sensor, optical(CPose3D(1, 0, 0) + mount)));
  EXPECT_TRUE(is_near(all[1].world_from_sensor, optical(CPose3D(2, 0, 0, 0.5, 0, 0) + mount)));
  EXPECT_THAT(notes_, ElementsAre(AllOf(StartsWith("DEPTH 3 is left out"), HasSubstr("20 ms"))));
  EXPECT_THAT(source_, HasSubstr("CObservationRobotPose"));
}

TEST_F(Rawlog, WheelsWillDoWhereThereIsNothingBetter) {
  const auto all = frames(write({wheels(1.0, 2.0, 0.5), range_scan(1.0)}));
  ASSERT_EQ(all.size(), 1U);
  EXPECT_TRUE(is_near(all[0].world_from_sensor, optical(CPose3D(2, 0, 0, 0.5, 0, 0) + mount)));
  EXPECT_THAT(source_, HasSubstr("they drift"));
}

/// The older format: a frame of observations, then how the robot moved, and again.
TEST_F(Rawlog, MovementsBetweenFramesAddUp) {
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

TEST_F(Rawlog, PosesOfATrajectoryAreTheOpticalFrames) {
  const std::string poses = folder_.write("poses.txt", "# t x y z q\n4.99 1 2 3 0 0 0 1\n");
  const auto all = frames(write({robot_pose(5.0, {9, 9, 9, 0, 0, 0}), range_scan(5.0)}),
                          {.sensor = "", .poses = poses});
  ASSERT_EQ(all.size(), 1U);
  Isometry3d expected = Isometry3d::Identity();
  expected.translation() = Vector3d(1, 2, 3);
  EXPECT_TRUE(all[0].world_from_sensor.isApprox(expected));
  EXPECT_THAT(complaint(write({range_scan(5.0)}), {.sensor = "", .poses = folder_ / "none"}),
              HasSubstr("none"));
}

TEST_F(Rawlog, WithoutPosesScansOrAChoiceIsRefused) {
  EXPECT_THAT(complaint(write({range_scan(1.0), std::make_shared<mrpt::obs::CObservationGPS>()})),
              AllOf(HasSubstr("x.rawlog: does not say where"), HasSubstr("--poses")));
  EXPECT_THAT(complaint(write({robot_pose(1.0, {})})), HasSubstr("has no scan that can be used"));
  const std::string two = write({robot_pose(1.0, {}), range_scan(1.0, "L"), range_scan(1.0, "R")});
  EXPECT_THAT(complaint(two), AllOf(HasSubstr("'L', 'R'"), HasSubstr("--sensor")));
  EXPECT_THAT(complaint(two, {.sensor = "M", .poses = {}}), HasSubstr("'M'; it has 'L', 'R'"));
  EXPECT_EQ(frames(two, {.sensor = "R", .poses = {}}).at(0).id, "R 2");
}

TEST_F(Rawlog, ImagesMayBeInFilesBesideIt) {
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
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("'image.bin', which is not there")));
  EXPECT_THAT(frames(outside("../image.bin")), IsEmpty());
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("outside of the rawlog's folder")));
}

TEST_F(Rawlog, LensesAndStepsThatAreNoneAreNamed) {
  const auto note = [&](const std::function<void(CObservation3DRangeScan&)>& spoil) {
    const auto scan = range_scan(1.0);
    spoil(*scan);
    EXPECT_THAT(frames(write({robot_pose(1.0, {}), scan})), IsEmpty());
    return notes_.at(0);
  };
  EXPECT_THAT(note([](auto& scan) { scan.cameraParams.fx(0.0); }), HasSubstr("no focal length"));
  EXPECT_THAT(note([](auto& scan) { scan.cameraParams.cx(NAN); }), HasSubstr("image centre"));
  EXPECT_THAT(note([](auto& scan) { scan.rangeUnits = 0.0F; }), HasSubstr("a step of its image"));
  EXPECT_THAT(note([](auto& scan) { scan.hasRangeImage = false; }), HasSubstr("neither"));
  EXPECT_THAT(note([](auto& scan) {
                scan.cameraParams.distortion = mrpt::img::DistortionModel::kannala_brandt;
              }),
              HasSubstr("fisheye"));
  EXPECT_THAT(note([](auto& scan) {
                scan.cameraParams.distortion = mrpt::img::DistortionModel::plumb_bob;
                scan.cameraParams.dist[6] = 0.1;
              }),
              HasSubstr("beyond k1 k2"));
  EXPECT_THAT(note([](auto& scan) { scan.sensorPose.x(1e30); }), HasSubstr("its pose"));
}

TEST_F(Rawlog, CloudsAreTakenAsTheyAre) {
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

/// One shot of a VLP-16's first channel, 15 degrees downwards, 5000 steps of 2 mm far.
TEST_F(Rawlog, PacketsOfAVelodyneBecomePoints) {
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
  EXPECT_NEAR(found[0].y(), 10.0 * std::sin(15.0 * std::numbers::pi / 180.0), 0.02);  // downwards
}

TEST_F(Rawlog, ThatEndsTooSoonIsRefused) {
  for (const std::string name : {"x.rawlog", "x.rawlog.gz"}) {
    const std::string whole =
        tests::content_of(write({robot_pose(1.0, {}), range_scan(1.0)}, name));
    for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 50) {
      const std::string what = complaint(folder_.write("cut_" + name, whole.substr(0, size)));
      EXPECT_THAT(what, HasSubstr("cut_" + name)) << size;
    }
  }
  EXPECT_THAT(complaint(folder_.write("text.rawlog", "this is a text and no rawlog at all")),
              HasSubstr("text.rawlog: entry 0 cannot be read"));
  EXPECT_THAT(complaint(folder_ / "nowhere.rawlog"), HasSubstr("is no file"));
}

/// MRPT allocates what a file says it needs: a count of points, and the sides of an image.
TEST_F(Rawlog, WithCountsThatAreNoneIsRefused) {
  const std::string whole = tests::content_of(write({robot_pose(1.0, {}), range_scan(1.0)}));
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
    EXPECT_THAT(complaint(folder_.write("hostile.rawlog", hostile)), HasSubstr("hostile.rawlog"))
        << rows << " x " << columns;
  }
}

TEST_F(Rawlog, ThatIsDamagedIsReadOrRefused) {
  auto frame = std::make_shared<mrpt::obs::CSensoryFrame>();
  frame->insert(range_scan(1.0));
  const std::string whole = tests::content_of(
      write({robot_pose(1.0, {}), wheels(1.0, 0, 0), range_scan(1.0, "DEPTH"), frame}));
  std::mt19937_64 random(1);
  // The bytes of the images' pixels are of no interest.
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const bool is_pixel = std::string_view(whole).substr(i, 3).find('\0') == std::string::npos;
    if (!is_pixel || i < 1000) places.push_back(i);
  }
  std::size_t refused = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::string damaged = whole;
    for (std::uint64_t count = 1 + random() % 3; count > 0; --count) {
      damaged[places[random() % places.size()]] = static_cast<char>(random());
    }
    refused += complaint(folder_.write("damaged.rawlog", damaged)).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 20U);
}

/// The same images by this door and as PNG files.
TEST_F(Rawlog, IsTakenInAsItsImagesWouldBe) {
  const std::string mission = folder_.write(
      "m.yaml",
      "sensor: {width: 32, height: 24, horizontal_fov_deg: 56.5, vertical_fov_deg: 43.5,\n"
      "         max_range: 8}\n"
      "planner: {density: 100, resolution_radius: 0.4,\n"
      "          scene_box: {min: [-6, -6, -6], max: [6, 6, 6]}}\n"
      "evaluation: {registration_distance: 0.1}\n"
      "live: {pose_check: false}\n");
  const std::string rawlog =
      write({robot_pose(1.0, {}), range_scan(1.0), robot_pose(2.0, {}), range_scan(2.0)});
  const auto next = [&](const std::string& survey, const std::vector<std::string>& more) {
    std::vector<std::string> all{"next", mission, "--survey", folder_ / survey};
    all.insert(all.end(), more.begin(), more.end());
    return tests::run_skycap(all);
  };
  const tests::ProgramRun all = next("all", {"--dataset", rawlog});
  EXPECT_THAT(all.err, AllOf(HasSubstr("poses are from its CObservationRobotPose"),
                             HasSubstr("DEPTH 1: "), HasSubstr("DEPTH 3: ")));
  EXPECT_THAT(next("all", {"--dataset", rawlog}).err, testing::Not(HasSubstr("points")));
  for (const double time : {1.0, 2.0}) {
    const auto scan = range_scan(time);
    const sim::DepthImage image{
        32, 24, {scan->rangeImage.data(), scan->rangeImage.data() + scan->rangeImage.size()}};
    sim::write_depth_png(image, folder_.path() / "image.png");
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> pose =
        optical(mount).getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>().asEigen();
    std::ostringstream text;
    text.precision(17);
    for (int i = 0; i < 16; ++i) text << pose.data()[i] << " ";
    EXPECT_LE(next("one", {"--scan", folder_ / "image.png", "--pose", text.str(), "--lens",
                           "30 31 15.2 12.1", "--depth-unit", "0.0005"})
                  .exit_code,
              11);
  }
  for (const char* name : {"scans/000000.ply", "scans/000001.ply"}) {
    const std::string one = tests::content_of(folder_.path() / "one" / name);
    EXPECT_EQ(tests::content_of(folder_.path() / "all" / name).size(), one.size());
    EXPECT_GT(one.size(), 5000U);
  }
}

}  // namespace
}  // namespace skycap::missions::dataset
