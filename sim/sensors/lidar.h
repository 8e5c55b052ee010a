/// Simulated laser scanner on a moving platform, with an individual time and pose for every pulse.
///
/// Between two firings, the pose is interpolated linearly, including the rotation matrix. At an
/// angular rate w, the direction error is at most (w * firing_period)^2 / 8, which is 1 um at 100 m
/// for 3 rad/s and 55 us. The trajectory itself is sampled at most every 100 us.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "sim/scene/scene.h"
#include "sim/sensors/sensor.h"
#include "sim/sensors/trajectory.h"

namespace skycap::sim {

/// True and estimated motion of the sensor.
struct LidarFlight {
  const Trajectory& ground_truth;
  const Trajectory& estimated;  ///< Estimated trajectory. May be the same object as `ground_truth`.
  Eigen::Isometry3d body_from_sensor = Eigen::Isometry3d::Identity();
  /// Calibrated mount, with errors of lever arm and boresight.
  Eigen::Isometry3d estimated_body_from_sensor = Eigen::Isometry3d::Identity();
};

/// Firings first, first + 1, ..., first + count - 1.
struct FiringRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

/// Returns in the order of measurement, as a structure of arrays. Points are relative to `origin`,
/// so that single precision suffices in any world frame.
struct LidarReturns {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< World frame [m].
  std::vector<Eigen::Vector3f> points;       ///< Reported points: measured range, estimated pose.
  std::vector<Eigen::Vector3f> true_points;  ///< Error-free points of the echoes.
  std::vector<double> times;                 ///< Time of the pulse [s].
  std::vector<float> intensities;  ///< reflectance * cos(incidence) * fraction of the beam.
  std::vector<float> scan_angles;  ///< Azimuth in the sensor frame, in (-pi, pi] [rad].
  /// Triangle of the scene's mesh that the strongest sub-ray hits.
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint16_t> channels;
  std::vector<std::uint8_t> return_numbers;     ///< Counted from 1, by range.
  std::vector<std::uint8_t> number_of_returns;  ///< Total number of returns of the pulse.

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
    number_of_returns.resize(size);
  }
};

/// Validated scanner. Immutable and thread-safe.
class Lidar {
 public:
  /// Throws the same errors as LidarConfig::validate().
  explicit Lidar(const LidarConfig& config);
  ~Lidar();
  Lidar(Lidar&&) noexcept;
  Lidar& operator=(Lidar&&) noexcept;

  const LidarConfig& config() const;

  /// Returns the number of complete firings during a trajectory.
  std::uint64_t firings(const Trajectory& trajectory) const;

  /// Returns the measurements of a range of firings, computed on the calling thread. A pure
  /// function of the firings: splitting the range gives identical returns. Efficient for ranges in
  /// multiples of 32 firings. Reuses the memory of `buffer`.
  LidarReturns measure(const Scene& scene, const LidarFlight& flight, FiringRange firings,
                       LidarReturns buffer = {}) const;

  struct Impl;  ///< Defined in the source file, where helpers use it.

 private:
  std::unique_ptr<const Impl> impl_;
};

}  // namespace skycap::sim
