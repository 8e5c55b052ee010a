#include "missions/scan_runner.h"

#include <cstring>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "geometry/error.h"
#include "missions/cloud_formats.h"
#include "missions/las_format.h"
#include "tests/sim/shapes.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;

std::vector<char> bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

template <typename Value>
Value value_at(const std::vector<char>& bytes, std::size_t place) {
  Value value;
  EXPECT_LE(place + sizeof value, bytes.size());
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

struct LasPoint {
  Vector3d position;
  int intensity, return_number, returns, channel;
  double angle_deg, time;
};

/// A reader by the letter of the LAS 1.4 R15 specification: header, point formats 6 and 7.
struct LasFile {
  std::vector<LasPoint> points;
  std::string crs;

  explicit LasFile(const std::filesystem::path& path, int point_format = 6) {
    const std::vector<char> bytes = bytes_of(path);
    EXPECT_EQ(std::string(bytes.data(), 4), "LASF");
    EXPECT_EQ(value_at<std::uint16_t>(bytes, 6), 0b10001);  // WKT, adjusted GPS time
    EXPECT_EQ(bytes[24], 1);
    EXPECT_EQ(bytes[25], 4);
    EXPECT_EQ(value_at<std::uint16_t>(bytes, 94), 375);
    const auto first_point = value_at<std::uint32_t>(bytes, 96);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, 100), 1U);
    EXPECT_EQ(bytes[104], point_format);
    const std::size_t size = point_format == 7 ? 36 : 30;
    EXPECT_EQ(value_at<std::uint16_t>(bytes, 105), size);
    for (std::size_t place = 107; place < 131; place += 4) {
      EXPECT_EQ(value_at<std::uint32_t>(bytes, place), 0U);
    }
    const auto count = value_at<std::uint64_t>(bytes, 247);
    EXPECT_EQ(bytes.size(), first_point + size * count);

    EXPECT_EQ(std::string(bytes.data() + 377), "LASF_Projection");
    EXPECT_EQ(value_at<std::uint16_t>(bytes, 393), 2112);
    const auto crs_size = value_at<std::uint16_t>(bytes, 395);
    EXPECT_EQ(first_point, 375U + 54 + crs_size);
    crs = std::string(bytes.data() + 429);
    EXPECT_EQ(crs.size() + 1, crs_size);

    Eigen::AlignedBox3d bounds;
    std::array<std::uint64_t, 15> by_return = {};
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::size_t at = first_point + size * i;
      LasPoint point;
      for (int axis = 0; axis < 3; ++axis) {
        point.position[axis] =
            value_at<std::int32_t>(bytes, at + 4 * axis) * value_at<double>(bytes, 131 + 8 * axis) +
            value_at<double>(bytes, 155 + 8 * axis);
      }
      point.intensity = value_at<std::uint16_t>(bytes, at + 12);
      point.return_number = bytes[at + 14] & 15;
      point.returns = (bytes[at + 14] >> 4) & 15;
      point.channel = static_cast<std::uint8_t>(bytes[at + 17]);
      point.angle_deg = 0.006 * value_at<std::int16_t>(bytes, at + 18);
      point.time = value_at<double>(bytes, at + 22);
      for (std::size_t colour = 30; colour < size; colour += 2) {
        EXPECT_EQ(value_at<std::uint16_t>(bytes, at + colour), point.intensity);
      }
      points.push_back(point);
      bounds.extend(point.position);
      ++by_return[point.return_number - 1];
    }
    for (int i = 0; i < 15; ++i) {
      EXPECT_EQ(value_at<std::uint64_t>(bytes, 255 + 8 * i), by_return[i]) << i;
    }
    if (count == 0) return;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(value_at<double>(bytes, 179 + 16 * axis), bounds.max()[axis], 1e-9);
      EXPECT_NEAR(value_at<double>(bytes, 187 + 16 * axis), bounds.min()[axis], 1e-9);
    }
  }
};

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

  ScanResult run(const std::filesystem::path& file, unsigned threads, std::stop_token stop = {}) {
    std::vector<CloudFile> files = las_files(file);
    const ScanResult result = run_scan(scene, sim::Lidar(config), {trajectory, trajectory}, files,
                                       {.threads = threads, .report = {}, .stop = std::move(stop)});
    files[0].finish();
    return result;
  }

  std::vector<CloudFile> las_files(const std::filesystem::path& file, int point_format = 6) const {
    std::vector<CloudFile> files;
    files.emplace_back(file, las_format({.point_format = point_format, .offset = far}));
    return files;
  }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("skycap_scan_" + std::to_string(getpid()));
  const Vector3d far{474'500.0, 5'474'500.0, 120.0};  // UTM: single precision has half metres there
  const sim::Scene scene{sim::sphere(far, 20.0, 4), 1};
  const sim::Trajectory trajectory{
      {{5.0, far, Eigen::Quaterniond::Identity()},
       {6.0, far + Vector3d(3, 0, 0), Eigen::Quaterniond::Identity()}}};
  sim::LidarConfig config;
};

TEST_F(ScanRunner, TheFileHoldsEveryReturnFieldByField) {
  config.beam = {
      .rings = 1, .divergence_horizontal = 0.002, .divergence_vertical = 0.002, .max_returns = 3};
  const ScanResult result = run(folder / "scan.las", 2);
  EXPECT_TRUE(result.is_complete);
  const LasFile file(folder / "scan.las");
  std::vector<CloudFile> coloured = las_files(folder / "coloured.las", 7);
  run_scan(scene, sim::Lidar(config), {trajectory, trajectory}, coloured, {});
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
    ASSERT_LT((point.position - expected).lpNorm<Eigen::Infinity>(), 0.51e-4);  // half a unit
    ASSERT_NEAR(point.intensity, 65535.0 * returns.intensities[i], 0.51);
    ASSERT_EQ(point.return_number, returns.return_numbers[i]);
    ASSERT_EQ(point.returns, returns.returns_of_shots[i]);
    ASSERT_EQ(point.channel, returns.channels[i]);
    ASSERT_NEAR(point.angle_deg, returns.scan_angles[i] * 57.29578, 0.0031);  // half a unit
    ASSERT_EQ(point.time, returns.times[i]);
  }
}

TEST_F(ScanRunner, GivesTheSameBytesForAnyNumberOfThreads) {
  run(folder / "one.las", 1);
  const std::vector<char> expected = bytes_of(folder / "one.las");
  ASSERT_GT(expected.size(), 1'000'000U);
  for (const unsigned threads : {2U, 4U}) {
    run(folder / "more.las", threads);
    EXPECT_EQ(bytes_of(folder / "more.las"), expected) << threads;
  }
}

TEST_F(ScanRunner, AStoppedScanLeavesAValidFileOfItsBeginning) {
  std::stop_source stop;
  std::vector<CloudFile> files = las_files(folder / "part.las");
  const auto stop_at_once = [&](const ScanProgress&) { stop.request_stop(); };
  config.channels.resize(1);
  const sim::Trajectory longer(
      {{0.0, far, Eigen::Quaterniond::Identity()}, {1000.0, far, Eigen::Quaterniond::Identity()}});
  const ScanResult result =
      run_scan(scene, sim::Lidar(config), {longer, longer}, files,
               {.threads = 1, .report = stop_at_once, .stop = stop.get_token()});
  files[0].finish();
  EXPECT_FALSE(result.is_complete);
  EXPECT_LT(result.progress.firings, result.progress.all_firings);
  EXPECT_EQ(LasFile(folder / "part.las").points.size(), result.progress.points);
  EXPECT_GT(result.progress.points, 0U);
}

TEST_F(ScanRunner, SaysWhatCannotBeWritten) {
  try {
    const CloudFile file(folder / "missing" / "scan.las", las_format({}));
    FAIL() << "written";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_file);
    EXPECT_THAT(error.what(), testing::HasSubstr("scan.las: cannot be written"));
  }
  for (const auto& format : {las_format({}), ply_format(), pcd_format()}) {
    std::vector<CloudFile> near_zero;
    near_zero.emplace_back(folder / "scan", format);
    EXPECT_THROW(run_scan(scene, sim::Lidar(config), {trajectory, trajectory}, near_zero, {}),
                 Error);
  }
  EXPECT_THROW(las_format({.point_format = 5}), Error);
}

}  // namespace
}  // namespace skycap::missions
