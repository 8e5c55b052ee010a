/// The simulated sensor of a survey: a depth camera, or a laser scanner.
///
/// A sweep is not organised: its scan has points and no pixels. A scanner that is not flown stands
/// at each view while it turns once, so that the middle of its lasers, at azimuth zero, is the
/// view's direction. One that is flown is fixed to an airframe that keeps level, its axis level
/// too: a view's direction is then anywhere in the ring that it sweeps, to the left of the axis,
/// and says where the nose points. Between two of its scans it turns several times, which are
/// measured as if from about the same place: a scan stands for the piece of the way that it is in
/// the middle of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "missions/file/mission.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::derived {

/// The pinhole camera that sees what a spinning scanner sees in the quarter turn before it, with as
/// many pixels as the scanner sends rays there: planners choose views by it. Throws
/// Error{bad_config} if the scanner does not spin or has not several lasers one above the other.
sim::DepthCameraConfig forward_camera(const sim::LidarConfig& lidar);

/// The pinhole camera that sees the quarter turn to the side of a scanner whose axis is level: as
/// wide as the lasers spread to either side, with as many pixels as rays are sent there in so many
/// turns. Throws what forward_camera() throws.
sim::DepthCameraConfig side_camera(const sim::LidarConfig& lidar, std::size_t turns = 1);

/// The turns of one scan are measured from places that are at most half of this from its own, along
/// the axis [m].
inline constexpr double spread_of_turns = 0.25;

/// How often a scanner turns in one of its scans: once, or in flight all the time between two.
std::size_t turns_of(const file::SensorConfig& sensor);

/// The greatest angle between neighbouring rays of one turn [rad].
double ray_spacing(const sim::LidarConfig& lidar);

/// Standard deviation of a range, head-on [m].
double range_noise(const sim::LidarConfig& lidar, double range);

/// Reads the scanner that `sensor.lidar` names, a path being relative to `folder`, and makes
/// `camera` its forward camera, or its side camera if `mount` is given. Throws what find_sensor()
/// and forward_camera() throw, and Error{bad_config} if the description is a camera's.
void use_lidar(file::SensorConfig& sensor, const std::filesystem::path& folder);

/// Of angles about the x, then the y, then the z axis, as missions give them [rad].
Eigen::Quaterniond rotation_of(const Eigen::Vector3d& angles);

/// How the scanner sits on its carrier, body_from_sensor, as `scan.mount` says.
Eigen::Isometry3d mount_of(const file::ScanConfig& scan);

/// Where the vehicle's nose points at a view of such a scanner, level; and the level view to the
/// left of the axis for a nose.
geometry::View nose_view(const Eigen::Isometry3d& mount, const geometry::View& view);
geometry::View side_view(const Eigen::Isometry3d& mount, const geometry::View& nose);

/// How a sensor is really carried, beside the view that it is believed to have.
struct Carriage {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();      ///< of its place [m]
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();       ///< small angles about world axes [rad]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();   ///< amid the scan [m/s]
  Eigen::Vector3d turn_rate = Eigen::Vector3d::Zero();  ///< about world axes [rad/s]
  int instants = 0;  ///< that stand for a camera's exposure; zero: it stands meanwhile

  /// The true pose where this one is believed.
  Eigen::Isometry3d true_pose(const Eigen::Isometry3d& believed) const;
};

/// Immutable; safe to use from any number of threads.
class SurveySensor {
 public:
  /// Throws what the sensor's configuration throws when it is not valid.
  SurveySensor(const file::SensorConfig& config, std::uint64_t seed);

  /// What is measured from `view`, in its optical frame (geometry::camera_pose()). With the seed,
  /// `frame` alone decides the noise; the result does not depend on `threads` (zero: all
  /// processors). The memory of `recycled` is used again.
  geometry::Scan scan(const sim::Scene& scene, const geometry::View& view, std::uint64_t frame,
                      unsigned threads, geometry::Scan recycled = {}) const;

  /// The same by a sensor that is carried so: its points are where they are thought to be. A
  /// scanner's velocity is not looked at, since its turns are measured from about one place.
  geometry::Scan scan(const sim::Scene& scene, const geometry::View& view, const Carriage& carriage,
                      std::uint64_t frame, unsigned threads, geometry::Scan recycled = {}) const;

 private:
  std::vector<Eigen::Isometry3d> turns(const geometry::View& view) const;

  std::variant<sim::DepthCamera, sim::Lidar> sensor_;
  flight::Shutter shutter_;
  std::optional<Eigen::Isometry3d> mount_;  ///< of a scanner that is flown
  std::size_t turns_ = 1;                   ///< that make a scan
};

}  // namespace skycap::missions::derived
