/// A simulated laser scanner on a moving platform: every shot has its own time and pose.
///
/// Between two firings the pose is interpolated linearly, rotation matrix included; at a rate of
/// turn w the direction is then off by at most (w * firing_period)^2 / 8, which is a micrometre at
/// 100 m for 3 rad/s and 55 microseconds. Where firings are closer than 100 microseconds the
/// trajectory itself is asked only that often.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "sim/scene/scene.h"
#include "sim/sensors/sensor.h"
#include "sim/sensors/trajectory.h"

namespace skycap::sim {

/// How the sensor moved, and how its carrier believes that it moved.
struct LidarFlight {
  const Trajectory& flown;
  const Trajectory& believed;  ///< may be the same object
  Eigen::Isometry3d body_from_sensor = Eigen::Isometry3d::Identity();
  /// What the calibration says: with errors of lever arm and boresight.
  Eigen::Isometry3d believed_body_from_sensor = Eigen::Isometry3d::Identity();
};

/// Firings first, first + 1, ..., first + count - 1.
struct FiringRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

/// Returns in the order in which they were measured; structure of arrays. Points are relative to
/// `origin`, so that single precision is enough in any world frame.
struct LidarReturns {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< world frame
  std::vector<Eigen::Vector3f> points;       ///< as reported: measured distance, believed pose
  std::vector<Eigen::Vector3f> true_points;  ///< of the echo, without any error
  std::vector<double> times;                 ///< of the shot [s]
  std::vector<float> intensities;            ///< reflectance * cos(incidence) * share of the beam
  std::vector<float> scan_angles;            ///< azimuth in the sensor's frame, in (-pi, pi] [rad]
  std::vector<std::uint32_t> triangles;      ///< of the scene's mesh; of the strongest sub-ray
  std::vector<std::uint16_t> channels;
  std::vector<std::uint8_t> return_numbers;    ///< counted from 1, by distance
  std::vector<std::uint8_t> returns_of_shots;  ///< how many returns the shot has in all

  std::size_t size() const { return points.size(); }
  void resize(std::size_t size) {
    points.resize(size);
    true_points.resize(size);
    times.resize(size);
    intensities.resize(size);
    scan_angles.resize(size);
    triangles.resize(size);
    channels.resize(size);
    return_numbers.resize(size);
    returns_of_shots.resize(size);
  }
};

/// A validated scanner. Immutable; safe to use from any number of threads.
class Lidar {
 public:
  /// Throws what LidarConfig::validate() throws.
  explicit Lidar(const LidarConfig& config);
  ~Lidar();
  Lidar(Lidar&&) noexcept;
  Lidar& operator=(Lidar&&) noexcept;

  const LidarConfig& config() const;

  /// The number of whole firings that a trajectory has time for.
  std::uint64_t firings(const Trajectory& trajectory) const;

  /// What the scanner measures in some firings, on this thread. A pure function of the firings:
  /// measuring them in parts, on any threads, gives the same returns. Ranges that are multiples of
  /// 32 firings waste nothing. The memory of `recycled` is used again.
  LidarReturns measure(const Scene& scene, const LidarFlight& flight, FiringRange firings,
                       LidarReturns recycled = {}) const;

  struct Impl;  ///< defined in the source, where it serves helpers

 private:
  std::unique_ptr<const Impl> impl_;
};

}  // namespace skycap::sim
