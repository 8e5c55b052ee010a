#include "missions/scan/scan_runner.h"

#include <cstring>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "geometry/error.h"
#include "geometry/io/e57_reader.h"
#include "geometry/io/las/las_reader.h"
#include "missions/scan/cloud_formats.h"
#include "missions/scan/las_format.h"
#include "tests/missions/scan/las_file.h"
#include "tests/sim/shapes.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;

class ScanRunner : public testing::Test {
 protected:
  ScanRunner() {
    config.firing_period = 1e-4;
    config.rotation_rate = 20.0;
    config.channels.clear();
    for (int i = 0; i < 16; ++i) config.channels.push_back({.elevation = 0.03 * i - 0.2});
    config.errors.sigma = 0.01;
    std::filesystem::create_directories(folder);
  }
  ~ScanRunner() override { std::filesystem::remove_all(folder); }

  scan::ScanResult run(const std::filesystem::path& file, unsigned threads) {
    std::vector<scan::CloudFile> files;
    files.emplace_back(file, format_for(file));
    const scan::ScanResult result = scan::run_scan(
        scene, sim::Lidar(config), {trajectory, trajectory}, files, {.threads = threads});
    files[0].finish();
    return result;
  }

  /// Selects the format by the file extension.
  std::shared_ptr<const scan::CloudFormat> format_for(const std::filesystem::path& file) const {
    if (file.extension() == ".e57") return scan::e57_format({.offset = far}, "test");
    return scan::las_format(
        {.point_format = 6, .is_compressed = file.extension() == ".laz", .grid = {.offset = far}});
  }

  std::vector<scan::CloudFile> las_files(const std::filesystem::path& file,
                                         int point_format = 6) const {
    std::vector<scan::CloudFile> files;
    files.emplace_back(file,
                       scan::las_format({.point_format = point_format, .grid = {.offset = far}}));
    return files;
  }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("skycap_scan_" + std::to_string(getpid()));
  // UTM, where single precision has a resolution of 0.5 m.
  const Vector3d far{474'500.0, 5'474'500.0, 120.0};
  const sim::Scene scene{sim::sphere(far, 20.0, 4), 1};
  const sim::Trajectory trajectory{
      {{5.0, far, Eigen::Quaterniond::Identity()},
       {6.0, far + Vector3d(3, 0, 0), Eigen::Quaterniond::Identity()}}};
  sim::LidarConfig config;
};

TEST_F(ScanRunner, WritesEveryFieldOfReturnsToLas) {
  config.beam = {
      .rings = 1, .divergence_horizontal = 0.002, .divergence_vertical = 0.002, .max_returns = 3};
  const scan::ScanResult result = run(folder / "scan.las", 2);
  EXPECT_TRUE(result.is_complete);
  const LasFile file(folder / "scan.las");
  std::vector<scan::CloudFile> coloured = las_files(folder / "coloured.las", 7);
  scan::run_scan(scene, sim::Lidar(config), {trajectory, trajectory}, coloured, {});
  coloured[0].finish();
  EXPECT_EQ(LasFile(folder / "coloured.las", 7).points.size(), file.points.size());
  const sim::LidarReturns returns =
      sim::Lidar(config).measure(scene, {trajectory, trajectory}, {0, 10'000});
  ASSERT_EQ(file.points.size(), returns.size());
  ASSERT_EQ(result.progress.points, returns.size());
  EXPECT_THAT(file.crs, testing::StartsWith("LOCAL_CS["));
  for (std::size_t i = 0; i < returns.size(); i += 37) {
    const LasPoint& point = file.points[i];
    const Vector3d expected = returns.origin + returns.points[i].cast<double>();
    // Half a unit of the last digit.
    ASSERT_LT((point.position - expected).lpNorm<Eigen::Infinity>(), 0.51e-4);
    ASSERT_NEAR(point.intensity, 65535.0 * returns.intensities[i], 0.51);
    ASSERT_EQ(point.return_number, returns.return_numbers[i]);
    ASSERT_EQ(point.returns, returns.number_of_returns[i]);
    ASSERT_EQ(point.channel, returns.channels[i]);
    // Half a unit of the last digit.
    ASSERT_NEAR(point.angle_deg, returns.scan_angles[i] * 57.29578, 0.0031);
    ASSERT_EQ(point.time, returns.times[i]);
  }
}

TEST_F(ScanRunner, WritesEveryReturnToE57) {
  const scan::ScanResult result = run(folder / "scan.e57", 2);
  geometry::E57Reader reader(folder / "scan.e57");
  EXPECT_THAT(reader.reference_system(), testing::StartsWith("LOCAL_CS["));
  EXPECT_EQ(reader.scans(), 1U);
  const sim::LidarReturns returns =
      sim::Lidar(config).measure(scene, {trajectory, trajectory}, {0, 10'000});
  ASSERT_EQ(result.progress.points, returns.size());
  ASSERT_EQ(reader.points(), returns.size());
  std::size_t next = 0;
  geometry::E57Points points;
  while (reader.next(points)) {
    for (const Vector3d& position : points.positions) {
      const Vector3d expected = returns.origin + returns.points[next++].cast<double>();
      // Half a unit of the last digit.
      ASSERT_LT((position - expected).lpNorm<Eigen::Infinity>(), 0.51e-4);
    }
  }
  EXPECT_EQ(next, returns.size());
}

TEST_F(ScanRunner, WritesSameBytesForAnyThreadCount) {
  for (const std::string extension : {".las", ".laz", ".e57"}) {
    run(folder / ("one" + extension), 1);
    const std::vector<char> expected = read_bytes(folder / ("one" + extension));
    ASSERT_GT(expected.size(), extension == ".laz" ? 300'000U : 1'000'000U);
    for (const unsigned threads : {2U, 4U}) {
      run(folder / ("more" + extension), threads);
      EXPECT_EQ(read_bytes(folder / ("more" + extension)), expected)
          << extension << ", " << threads;
    }
  }
}

// The compressed file contains the same points as the uncompressed one, byte by byte.
TEST_F(ScanRunner, CompressesSamePoints) {
  config.beam = {
      .rings = 1, .divergence_horizontal = 0.002, .divergence_vertical = 0.002, .max_returns = 3};
  run(folder / "scan.las", 2);
  run(folder / "scan.laz", 2);
  EXPECT_LT(2 * std::filesystem::file_size(folder / "scan.laz"),
            std::filesystem::file_size(folder / "scan.las"));
  geometry::LasReader plain(folder / "scan.las", geometry::LasFields::all),
      compressed(folder / "scan.laz", geometry::LasFields::all);
  ASSERT_EQ(compressed.header().points, plain.header().points);
  EXPECT_TRUE(compressed.header().is_compressed);
  EXPECT_EQ(compressed.reference_system().wkt, plain.reference_system().wkt);
  std::string expected, found;
  while (plain.next_records(expected)) {
    ASSERT_TRUE(compressed.next_records(found));
    ASSERT_TRUE(found == expected);
  }
}

TEST_F(ScanRunner, WritesValidFileWhenStopped) {
  std::stop_source stop;
  std::vector<scan::CloudFile> files = las_files(folder / "part.las");
  const auto stop_at_once = [&](const scan::ScanProgress&) { stop.request_stop(); };
  config.channels.resize(1);
  const sim::Trajectory longer(
      {{0.0, far, Eigen::Quaterniond::Identity()}, {1000.0, far, Eigen::Quaterniond::Identity()}});
  const scan::ScanResult result =
      scan::run_scan(scene, sim::Lidar(config), {longer, longer}, files,
                     {.threads = 1, .report = stop_at_once, .stop = stop.get_token()});
  files[0].finish();
  EXPECT_FALSE(result.is_complete);
  EXPECT_LT(result.progress.firings, result.progress.all_firings);
  EXPECT_EQ(LasFile(folder / "part.las").points.size(), result.progress.points);
  EXPECT_GT(result.progress.points, 0U);
}

// Resumes from each checkpoint that a kill may leave, with any data appended after it.
TEST_F(ScanRunner, ResumesFromAnyCheckpointToSameBytes) {
  struct Checkpoint {
    scan::ScanProgress progress;
    scan::CloudState state;
  };
  for (const std::string extension : {".las", ".laz", ".e57"}) {
    const std::filesystem::path whole = folder / ("whole" + extension),
                                killed = folder / ("killed" + extension);
    run(whole, 1);
    std::vector<Checkpoint> checkpoints;
    std::vector<scan::CloudFile> files;
    files.emplace_back(killed, format_for(killed));
    scan::run_scan(scene, sim::Lidar(config), {trajectory, trajectory}, files,
                   {.threads = 2,
                    .checkpoint =
                        [&](const scan::ScanProgress& progress) {
                          checkpoints.push_back({progress, files[0].state()});
                        },
                    .checkpoint_period = 0.0});
    files.clear();
    ASSERT_GT(checkpoints.size(), 10U);
    for (std::size_t i = 0; i < checkpoints.size(); i += 9) {
      const auto& [progress, state] = checkpoints[i];
      const std::filesystem::path file = folder / ("from" + std::to_string(i) + extension);
      std::filesystem::copy_file(killed, file);
      std::vector<scan::CloudFile> grown;
      grown.emplace_back(file, format_for(file), scan::ReturnPosition::reported, state);
      const scan::ScanResult result =
          scan::run_scan(scene, sim::Lidar(config), {trajectory, trajectory}, grown,
                         {.threads = 2, .begun = progress});
      grown[0].finish();
      EXPECT_TRUE(result.is_complete);
      EXPECT_EQ(read_bytes(file), read_bytes(whole)) << file;
    }
  }
  std::vector<scan::CloudFile> none;
  EXPECT_THAT(testing_support::thrown_message([&] {
                scan::run_scan(scene, sim::Lidar(config), {trajectory, trajectory}, none,
                               {.begun = {.firings = 1}});
              }),
              testing::HasSubstr("it ends after 1 firings"));
  EXPECT_THAT(testing_support::thrown_message([&] {
                scan::CloudFile(folder / "whole.las", scan::las_format({}),
                                scan::ReturnPosition::reported,
                                scan::CloudState{{}, 1'000'000'000});
              }),
              testing::HasSubstr("less than the 1000000000"));
}

TEST_F(ScanRunner, ReportsWriteErrors) {
  try {
    const scan::CloudFile file(folder / "missing" / "scan.las", scan::las_format({}));
    FAIL() << "written";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_file);
    EXPECT_THAT(error.what(), testing::HasSubstr("scan.las: cannot be written"));
  }
  for (const auto& format :
       {scan::las_format({}), scan::e57_format({}, ""), scan::ply_format(), scan::pcd_format()}) {
    std::vector<scan::CloudFile> near_zero;
    near_zero.emplace_back(folder / "scan", format);
    EXPECT_THAT(
        testing_support::thrown_message([&] {
          scan::run_scan(scene, sim::Lidar(config), {trajectory, trajectory}, near_zero, {});
        }),
        testing::HasSubstr("a point is "));
  }
  EXPECT_THAT(testing_support::thrown_message([&] { scan::las_format({.point_format = 5}); }),
              testing::HasSubstr("las.point_format is 5"));
}

}  // namespace
}  // namespace skycap::missions
