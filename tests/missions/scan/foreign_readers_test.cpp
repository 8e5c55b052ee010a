// PCL and MRPT, the libraries of the users, read the output of `skycap scan`.
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CRawlog.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include "geometry/io/cloud_io.h"
#include "geometry/io/output_folder.h"
#include "missions/scan/cloud_formats.h"
#include "missions/scan/frame_recorder.h"
#include "missions/scan/scan_route.h"
#include "missions/scan/scan_runner.h"
#include "tests/missions/scan/las_file.h"
#include "tests/sim/shapes.h"
#include "tests/support/not_empty.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// 0.1 s inside a sphere, with a moving and rotating platform and navigation errors.
class ForeignReader : public testing::Test {
 protected:
  ForeignReader() {
    config.firing_period = 1e-4;
    config.rotation_rate = 20.0;
    config.radial_offset = 0.03;
    config.max_range = 40.0;
    config.channels.clear();
    for (int i = 0; i < 8; ++i) {
      config.channels.push_back({.elevation = 0.05 * i - 0.2, .delay = 2e-6 * i, .height = 0.04});
    }
    config.errors.sigma = 0.01;
    returns = sim::Lidar(config).measure(scene, lidar_flight, {0, 1000});
  }

  std::string written(const std::string& format) const {
    const scan::CloudFormatInfo& info = scan::cloud_format_named(format);
    const std::string path = folder.path() / ("scan" + info.extension);
    std::vector<scan::CloudFile> files;
    files.emplace_back(path, info.make({"test", config, lidar_flight, Vector3d::Zero()}));
    EXPECT_TRUE(scan::run_scan(scene, sim::Lidar(config), lidar_flight, files, {}).is_complete);
    files[0].finish();
    EXPECT_EQ(files[0].bytes(), std::filesystem::file_size(path));
    return path;
  }

  /// Expects each field of each point, and no other fields.
  void expect_fields(const pcl::PCLPointCloud2& cloud) const {
    ASSERT_EQ(cloud.width * cloud.height, returns.size());
    std::vector<std::string> names;
    for (const pcl::PCLPointField& field : cloud.fields) names.push_back(field.name);
    EXPECT_THAT(names, testing::ElementsAre("x", "y", "z", "intensity", "time", "channel",
                                            "return_number", "returns"));
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const std::uint8_t* const point = cloud.data.data() + i * cloud.point_step;
      const auto value = [&]<typename Value>(std::size_t field, Value) {
        Value read;
        std::memcpy(&read, point + cloud.fields[field].offset, sizeof read);
        return read;
      };
      const Vector3d world = returns.origin + returns.points[i].cast<double>();
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(value(axis, 0.0F), static_cast<float>(world[axis]));
      }
      ASSERT_EQ(value(3, 0.0F), returns.intensities[i]);
      ASSERT_EQ(value(4, 0.0), returns.times[i]);
      ASSERT_EQ(value(5, std::uint16_t{}), returns.channels[i]);
      ASSERT_EQ(value(6, std::uint8_t{}), returns.return_numbers[i]);
      ASSERT_EQ(value(7, std::uint8_t{}), returns.number_of_returns[i]);
    }
  }

  const testing_support::TemporaryFolder folder;
  const sim::Scene scene{sim::sphere({1, 2, 3}, 20.0, 6), 1};
  const sim::Trajectory ground_truth{
      {{5.0, {0, 0, 0}, Quaterniond::Identity()},
       {5.1, {1, 0, 0}, Quaterniond(AngleAxisd(0.05, Vector3d::UnitZ()))}}};
  const sim::Trajectory estimated{
      {{5.0, {0.5, 0, 0}, Quaterniond(AngleAxisd(0.01, Vector3d::UnitX()))},
       {5.1, {1.5, 0, 0}, Quaterniond(AngleAxisd(0.05, Vector3d::UnitZ()))}}};
  const Isometry3d mount{Eigen::Translation3d(0.2, 0.0, -0.1) * AngleAxisd(0.3, Vector3d::UnitY())};
  const sim::LidarFlight lidar_flight{ground_truth, estimated, mount, mount};
  sim::LidarConfig config;
  sim::LidarReturns returns;
};

TEST_F(ForeignReader, ReadsEveryFieldOfPcdWithPcl) {
  pcl::PCLPointCloud2 cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(written("pcd"), cloud), 0);
  expect_fields(cloud);
}

TEST_F(ForeignReader, ReadsEveryFieldOfPlyWithPcl) {
  pcl::PCLPointCloud2 cloud;
  ASSERT_EQ(pcl::io::loadPLYFile(written("ply"), cloud), 0);
  expect_fields(cloud);
}

/// Returns the standard deviation of the points' distances from the centre of the measured sphere.
double scatter(const std::vector<Vector3d>& points) {
  double sum = 0.0, squares = 0.0;
  for (const Vector3d& point : points) {
    // Small values avoid cancellation.
    const double error = (point - Vector3d(1, 2, 3)).norm() - 20.0;
    sum += error;
    squares += error * error;
  }
  const auto n = static_cast<double>(points.size());
  return std::sqrt(squares / n - sum * sum / (n * n));
}

// Each file contains the noise exactly once: sigma = 0.01 m along rays that hit the sphere within
// 11 degrees of its normal. The triangles are at most 2 mm inside it. The tolerance is four
// standard deviations of the estimate from 8000 points, plus 2% for the angle.
TEST_F(ForeignReader, FindsNoiseOnceInEveryFormat) {
  const sim::LidarFlight faultless{ground_truth, ground_truth, mount, mount};
  const auto cloud_path = [&](const std::string& format) {
    const scan::CloudFormatInfo& info = scan::cloud_format_named(format);
    const std::string path = folder.path() / ("noise" + info.extension);
    std::vector<scan::CloudFile> files;
    files.emplace_back(path, info.make({"test", config, faultless, Vector3d::Zero()}));
    EXPECT_TRUE(scan::run_scan(scene, sim::Lidar(config), faultless, files, {}).is_complete);
    files[0].finish();
    return path;
  };
  std::map<std::string, std::vector<Vector3d>> clouds;
  for (const std::string format : {"e57", "ply", "xyz"}) {
    for (const auto& point : geometry::read_cloud(cloud_path(format)).positions) {
      clouds[format].push_back(point.cast<double>());
    }
  }
  pcl::PointCloud<pcl::PointXYZ> pcd;
  ASSERT_EQ(pcl::io::loadPCDFile(cloud_path("pcd"), pcd), 0);
  for (const auto& point : pcd) clouds["pcd"].push_back(point.getVector3fMap().cast<double>());
  for (const std::string format : {"las", "las7"}) {
    for (const LasPoint& point : LasFile(cloud_path(format), format == "las7" ? 7 : 6).points) {
      clouds[format].push_back(point.position);
    }
  }
  EXPECT_EQ(clouds.size(), 6U);
  for (const auto& [format, points] : clouds) {
    ASSERT_EQ(points.size(), returns.size()) << format;
    EXPECT_NEAR(scatter(points), 0.0099, 4e-4) << format;
  }
}

Isometry3d eigen_pose(const mrpt::poses::CPose3D& pose) {
  Isometry3d result;
  result.matrix() = pose.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>().asEigen();
  return result;
}

// Uses MRPT's own loader. The clouds of the pieces, at the estimated platform poses, form the
// cloud.
TEST_F(ForeignReader, ReadsPointPositionsOfRawlogWithMrpt) {
  mrpt::obs::CRawlog rawlog;
  ASSERT_TRUE(rawlog.loadFromRawLogFile(written("rawlog")));
  ASSERT_EQ(rawlog.size() % 3, 0U);
  std::size_t next = 0;
  for (std::size_t chunk = 0; chunk < rawlog.size(); chunk += 3) {
    const auto pose =
        std::dynamic_pointer_cast<mrpt::obs::CObservationRobotPose>(rawlog.getAsObservation(chunk));
    const auto cloud = std::dynamic_pointer_cast<mrpt::obs::CObservationPointCloud>(
        rawlog.getAsObservation(chunk + 2));
    ASSERT_TRUE(pose && cloud);
    EXPECT_NEAR(mrpt::Clock::toDouble(cloud->timestamp), returns.times[next], 1e-4);
    const Isometry3d world_from_sensor =
        eigen_pose(pose->pose.mean) * eigen_pose(cloud->sensorPose);
    for (std::size_t i = 0; i < cloud->pointcloud->size(); ++i, ++next) {
      Eigen::Vector3f point;
      cloud->pointcloud->getPoint(i, point.x(), point.y(), point.z());
      const Vector3d world = world_from_sensor * point.cast<double>();
      const Vector3d expected = returns.origin + returns.points[next].cast<double>();
      ASSERT_LT((world - expected).norm(), 1e-5);  // single precision at 20 m
    }
  }
  EXPECT_EQ(next, returns.size());
}

// The range image and its azimuths reproduce the points, up to half a range step and the sensor's
// motion during a pulse.
TEST_F(ForeignReader, ReadsRangeImagesOfRawlogWithMrpt) {
  mrpt::obs::CRawlog rawlog;
  ASSERT_TRUE(rawlog.loadFromRawLogFile(written("rawlog")));
  std::size_t pixels = 0, next = 0;
  for (std::size_t chunk = 0; chunk < rawlog.size(); chunk += 3) {
    const auto scan = std::dynamic_pointer_cast<mrpt::obs::CObservationRotatingScan>(
        rawlog.getAsObservation(chunk + 1));
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->rowCount, 8);
    EXPECT_EQ(scan->rangeResolution, 1e-3);
    EXPECT_EQ(scan->lidarModel, "test");
    for (int column = 0; column < scan->columnCount; ++column) {
      const double azimuth = scan->startAzimuth + scan->azimuthSpan * column / scan->columnCount;
      for (int row = 0; row < 8; ++row, ++next) {
        ASSERT_EQ(returns.channels[next], row);
        const double time = returns.times[next], delay = config.channels[row].delay;
        const double angle = azimuth + 2 * std::numbers::pi * 20 * delay;
        const double range = scan->rangeImage(row, column) * scan->rangeResolution;
        const double elevation = config.channels[row].elevation;
        const Vector3d point(range * std::cos(elevation) * std::cos(angle) + 0.03 * std::cos(angle),
                             range * std::cos(elevation) * std::sin(angle) + 0.03 * std::sin(angle),
                             range * std::sin(elevation) + 0.04);
        const Vector3d world = estimated.pose(time) * mount * point;
        const Vector3d expected = returns.origin + returns.points[next].cast<double>();
        ASSERT_LT((world - expected).norm(), 0.6e-3) << row << ", " << column;
        ++pixels;
      }
    }
  }
  EXPECT_EQ(pixels, returns.size());
}

// Reads files that PCL writes in its three formats. A NaN is a no-return pixel.
TEST_F(ForeignReader, ReadsFilesWrittenByPcl) {
  pcl::PointCloud<pcl::PointNormal> cloud;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> any(-50.0F, 50.0F);
  for (int i = 0; i < 2000; ++i) {
    const float x = i % 100 == 7 ? std::numeric_limits<float>::quiet_NaN() : any(random);
    cloud.emplace_back(x, std::round(any(random)), 3.0F, 0.0F, 0.6F, 0.8F);
  }
  const std::string path = folder.path() / "pcl.pcd";
  for (int variant = 0; variant < 3; ++variant) {
    const int error = variant == 0   ? pcl::io::savePCDFileASCII(path, cloud)
                      : variant == 1 ? pcl::io::savePCDFileBinary(path, cloud)
                                     : pcl::io::savePCDFileBinaryCompressed(path, cloud);
    ASSERT_EQ(error, 0);
    const geometry::AttributedCloud read = geometry::read_cloud(path);
    ASSERT_EQ(read.positions.size(), 1980U);
    ASSERT_EQ(read.normals.size(), read.positions.size());
    std::size_t next = 0;
    for (const pcl::PointNormal& point : testing_support::not_empty(cloud)) {
      if (std::isnan(point.x)) continue;
      // PCL writes text with eight digits.
      ASSERT_LT((read.positions[next] - point.getVector3fMap()).norm(),
                variant == 0 ? 1e-5F : 1e-30F);
      ASSERT_LT((read.normals[next++] - Eigen::Vector3f(0.0F, 0.6F, 0.8F)).norm(), 1e-6F);
    }
  }
}

TEST_F(ForeignReader, ReadsBackSkycapFiles) {
  for (const std::string format : {"e57", "las", "las7", "laz", "pcd", "ply", "xyz"}) {
    const geometry::AttributedCloud read = geometry::read_cloud(written(format));
    ASSERT_EQ(read.positions.size(), returns.size()) << format;
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const Vector3d world = returns.origin + returns.points[i].cast<double>();
      ASSERT_LT((read.positions[i].cast<double>() - world).norm(), 1e-4) << format;
    }
  }
}

// MRPT projects the images to points, which are on the sphere at the estimated platform pose.
// Depths are rounded to 1 mm, an error of up to 0.5 mm or 0.7 mm along a slanted ray. The largest
// triangles are up to 6.2 mm inside the sphere.
TEST_F(ForeignReader, ProjectsDepthImagesOntoSurfaceWithMrpt) {
  sim::DepthCameraConfig camera;
  camera.camera.width = 64;
  camera.camera.height = 48;
  std::vector<scan::Frame> frames;
  for (int i = 0; i < 3; ++i) {
    const double time = 5.0 + 0.05 * i;
    const Isometry3d pose = ground_truth.pose(time) * mount * scan::body_from_camera();
    frames.push_back({time, pose, pose});
  }
  const std::string out = folder.path() / "frames";
  geometry::OutputFolder output(out);
  scan::ScanJournal journal(out);
  journal.open({}, nlohmann::ordered_json::object(), false);
  const scan::FrameResult result =
      scan::record_frames(scene, sim::DepthCamera(camera), frames, journal, output,
                          {.has_rawlog = true, .report = {}, .stop = {}});
  output.commit();
  ASSERT_EQ(result.points, 3U * 64 * 48);

  mrpt::obs::CRawlog rawlog;
  ASSERT_TRUE(rawlog.loadFromRawLogFile(out + "/frames.rawlog"));
  ASSERT_EQ(rawlog.size(), 6U);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto pose =
        std::dynamic_pointer_cast<mrpt::obs::CObservationRobotPose>(rawlog.getAsObservation(2 * i));
    const auto image = std::dynamic_pointer_cast<mrpt::obs::CObservation3DRangeScan>(
        rawlog.getAsObservation(2 * i + 1));
    ASSERT_TRUE(pose && image);
    EXPECT_NEAR(mrpt::Clock::toDouble(image->timestamp), frames[i].time, 1e-6);
    mrpt::obs::T3DPointsProjectionParams projection;
    projection.takeIntoAccountSensorPoseOnRobot = true;
    projection.robotPoseInTheWorld = pose->pose.mean;
    mrpt::maps::CSimplePointsMap points;
    image->unprojectInto(points, projection);
    ASSERT_EQ(points.size(), 64U * 48);
    for (std::size_t j = 0; j < points.size(); ++j) {
      Eigen::Vector3f point;
      points.getPoint(j, point.x(), point.y(), point.z());
      const double radius = (point.cast<double>() - Vector3d(1, 2, 3)).norm();
      ASSERT_LT(radius, 20.0007);
      ASSERT_GT(radius, 20.0 - 0.0062 - 0.0007);
    }
  }
}

}  // namespace
}  // namespace skycap::missions
