/// Rawlogs written by MRPT's library, for tests.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/serialization/CArchive.h>

#include "missions/online/recordings/rawlog_sequence.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"

namespace skycap::missions::online {

using mrpt::obs::CObservation3DRangeScan;
using mrpt::poses::CPose3D;
using Objects = std::vector<mrpt::serialization::CSerializable::Ptr>;

/// Pose of the sensor on its platform.
inline const CPose3D mount(0.3, -0.2, 0.1, 0.4, -0.3, 0.2);

/// Returns a depth image of 32 x 24 pixels. A fifth of them are no-return pixels.
inline std::shared_ptr<CObservation3DRangeScan> range_scan(double time,
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

inline auto robot_pose(double time, const CPose3D& pose) {
  auto observation = std::make_shared<mrpt::obs::CObservationRobotPose>();
  observation->timestamp = mrpt::Clock::fromDouble(time);
  observation->sensorLabel = "POSE";
  observation->pose.mean = pose;
  return observation;
}

inline auto wheels(double time, double x, double heading) {
  auto observation = std::make_shared<mrpt::obs::CObservationOdometry>();
  observation->timestamp = mrpt::Clock::fromDouble(time);
  observation->odometry = mrpt::poses::CPose2D(x, 0.0, heading);
  return observation;
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
    reports_.clear();
    RawlogSequence sequence(
        file, choice, [&](const std::string& note) { notes_.push_back(note); },
        [&](const std::string& report) { reports_.push_back(report); });
    source_ = sequence.pose_source();
    std::vector<RawlogFrame> all;
    while (auto frame = sequence.next()) all.push_back(std::move(*frame));
    return all;
  }

  std::string error_message(const std::string& file, const RawlogChoice& choice = {}) {
    const std::string what = testing_support::thrown_message([&] { frames(file, choice); });
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
  }

  /// Returns the points of a frame for a survey without a range filter.
  static std::vector<Eigen::Vector3f> points(const RawlogFrame& frame) {
    return make_scan(frame, {.is_scanner = true}, {}).scan.points;
  }

  tests::TestFolder folder_;
  std::vector<std::string> notes_, reports_;
  std::string source_;
};

}  // namespace skycap::missions::online
