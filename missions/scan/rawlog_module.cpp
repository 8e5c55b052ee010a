// Encoder of MRPT rawlogs: a sequence of observations in MRPT's own serialisation.
#include "missions/scan/rawlog_module.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/serialization/CArchive.h>

namespace skycap::missions::scan {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

mrpt::poses::CPose3D mrpt_pose(const Isometry3d& pose) {
  return mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(pose.matrix()));
}

class RawlogFormat final : public CloudFormat {
 public:
  explicit RawlogFormat(const RawlogSetup& setup) : setup_(setup) {
    // Ranges have 16 bits. The step is the smallest multiple of a millimetre that covers the
    // maximum range.
    const double finest = setup.sensor.max_range / std::numeric_limits<std::uint16_t>::max();
    range_step_ = 1e-3 * std::max(1.0, std::ceil(1e3 * finest));
  }

  std::vector<std::uint8_t> header(const CloudState&) const override { return {}; }

  void encode(const sim::LidarReturns& returns, ReturnPosition position,
              CloudChunk& chunk) const override {
    chunk.totals = {};
    chunk.totals.points = returns.size();
    chunk.bytes.clear();
    if (returns.size() == 0) return;
    const SensorMotion& motion =
        position == ReturnPosition::reported ? setup_.reported : setup_.actual;
    const FiringBlock firing_block = make_firing_block(returns, position, motion);
    mrpt::io::CMemoryStream stream;
    auto archive = mrpt::serialization::archiveFrom(stream);
    archive << pose_observation(firing_block, motion);
    if (setup_.sensor.prisms.empty()) archive << range_image(firing_block, returns, motion);
    archive << point_cloud(firing_block, returns, motion);
    const auto* bytes = static_cast<const std::uint8_t*>(stream.getRawBufferData());
    chunk.bytes.assign(bytes, bytes + stream.getTotalBytesCount());
  }

 private:
  // Returns in the sensor frame.
  struct FiringBlock {
    double time = 0.0;                   // Time of the first firing [s].
    std::uint64_t first = 0, count = 0;  // Range of firings.
    std::vector<std::uint64_t> firings;  // Firing of each return.
    std::vector<Vector3d> now;           // Positions in the sensor frame at the time of the return.
    std::vector<Vector3d> at_start;      // Positions in the sensor frame at `time`.
  };

  double firing_time(std::uint64_t firing) const {
    return setup_.start + static_cast<double>(firing) * setup_.sensor.firing_period;
  }

  FiringBlock make_firing_block(const sim::LidarReturns& returns, ReturnPosition position,
                                const SensorMotion& motion) const {
    const auto& points = select_positions(returns, position);
    FiringBlock firing_block;
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const double since_start =
          returns.times[i] - setup_.start - setup_.sensor.channels[returns.channels[i]].delay;
      firing_block.firings.push_back(
          static_cast<std::uint64_t>(std::llround(since_start / setup_.sensor.firing_period)));
    }
    const auto [min, max] =
        std::minmax_element(firing_block.firings.begin(), firing_block.firings.end());
    firing_block.first = *min;
    firing_block.count = *max - *min + 1;
    firing_block.time = firing_time(firing_block.first);
    const auto sensor_from_world = [&](double time) {
      return (motion.world_from_platform(time) * motion.platform_from_sensor).inverse();
    };
    const Isometry3d start_from_world = sensor_from_world(firing_block.time);
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const Vector3d world = returns.origin + points[i].cast<double>();
      firing_block.now.push_back(sensor_from_world(returns.times[i]) * world);
      firing_block.at_start.push_back(start_from_world * world);
    }
    return firing_block;
  }

  template <typename Observation>
  void label(Observation& observation, const FiringBlock& firing_block, const char* name) const {
    observation.timestamp = mrpt::Clock::fromDouble(firing_block.time);
    observation.sensorLabel = name;
  }

  mrpt::obs::CObservationRobotPose pose_observation(const FiringBlock& firing_block,
                                                    const SensorMotion& motion) const {
    mrpt::obs::CObservationRobotPose observation;
    label(observation, firing_block, "CARRIER");
    observation.pose.mean = mrpt_pose(motion.world_from_platform(firing_block.time));
    return observation;
  }

  double encoder(std::uint64_t firing) const {
    const double turns =
        setup_.sensor.rotation_rate * static_cast<double>(firing) * setup_.sensor.firing_period;
    return 2.0 * std::numbers::pi * (turns - std::floor(turns));
  }

  // Returns the position where the laser beam leaves the sensor.
  Vector3d compute_beam_origin(std::uint64_t firing, const sim::Channel& channel) const {
    const double angle =
        encoder(firing) + 2.0 * std::numbers::pi * setup_.sensor.rotation_rate * channel.delay;
    const double radius = setup_.sensor.radial_offset;
    return {radius * std::cos(angle), radius * std::sin(angle), channel.height};
  }

  mrpt::obs::CObservationRotatingScan range_image(const FiringBlock& firing_block,
                                                  const sim::LidarReturns& returns,
                                                  const SensorMotion& motion) const {
    const sim::LidarConfig& sensor = setup_.sensor;
    mrpt::obs::CObservationRotatingScan scan;
    label(scan, firing_block, "LIDAR_RANGES");
    scan.originalReceivedTimestamp = scan.timestamp;
    scan.rowCount = static_cast<std::uint16_t>(sensor.channels.size());
    scan.columnCount = static_cast<std::uint16_t>(firing_block.count);
    scan.rangeImage.resize(scan.rowCount, scan.columnCount);
    scan.rangeImage.fill(0);
    scan.intensityImage.resize(scan.rowCount, scan.columnCount);
    scan.intensityImage.fill(0);
    scan.rangeResolution = range_step_;
    scan.startAzimuth = std::remainder(encoder(firing_block.first), 2.0 * std::numbers::pi);
    const double duration = static_cast<double>(firing_block.count) * sensor.firing_period;
    scan.azimuthSpan = 2.0 * std::numbers::pi * sensor.rotation_rate * duration;
    scan.sweepDuration = duration;
    scan.lidarModel = setup_.sensor_name;
    scan.minRange = sensor.min_range;
    scan.maxRange = sensor.max_range;
    scan.sensorPose = mrpt_pose(motion.platform_from_sensor);
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const std::uint64_t firing = firing_block.firings[i];
      const int row = returns.channels[i], column = static_cast<int>(firing - firing_block.first);
      const double range =
          (firing_block.now[i] - compute_beam_origin(firing, sensor.channels[returns.channels[i]]))
              .norm();
      const auto steps =
          static_cast<std::uint16_t>(std::clamp<long>(std::lround(range / range_step_), 1, 65535));
      // The image contains the strongest return of a pulse; the point cloud contains all.
      const auto brightness = static_cast<std::uint8_t>(
          std::lround(255.0F * std::clamp(returns.intensities[i], 0.0F, 1.0F)));
      if (scan.rangeImage(row, column) != 0 && scan.intensityImage(row, column) >= brightness) {
        continue;
      }
      scan.rangeImage(row, column) = steps;
      scan.intensityImage(row, column) = brightness;
    }
    return scan;
  }

  mrpt::obs::CObservationPointCloud point_cloud(const FiringBlock& firing_block,
                                                const sim::LidarReturns& returns,
                                                const SensorMotion& motion) const {
    auto points = mrpt::maps::CPointsMapXYZI::Create();
    points->reserve(returns.size());
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const Eigen::Vector3f point = firing_block.at_start[i].cast<float>();
      points->insertPointRGB(point.x(), point.y(), point.z(), returns.intensities[i], 0.0F, 0.0F);
    }
    mrpt::obs::CObservationPointCloud observation;
    label(observation, firing_block, "LIDAR_POINTS");
    observation.pointcloud = points;
    observation.sensorPose = mrpt_pose(motion.platform_from_sensor);
    return observation;
  }

  RawlogSetup setup_;
  double range_step_ = 1e-3;
};

}  // namespace
}  // namespace skycap::missions::scan

extern "C" [[gnu::visibility("default")]] skycap::missions::scan::CloudFormat*
skycap_make_rawlog_format(const skycap::missions::scan::RawlogSetup& setup) {
  return new skycap::missions::scan::RawlogFormat(setup);
}
