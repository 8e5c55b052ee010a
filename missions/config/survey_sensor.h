/// The simulated sensor of a survey: a depth camera, or a laser scanner.
///
/// A scanner's scan is not organised: it has points and no pixels. A scanner that is not flown
/// stands at each view. A ring turns once there, so that the middle of its lasers, at azimuth zero,
/// is the view's direction; a rosette looks along it for rosette_period. One that is flown is fixed
/// to an airframe that keeps level, and a view says where the nose points. The axis of a ring or a
/// line is level, too: a view's direction is anywhere in what it sweeps, to the left of the axis. A
/// rosette looks where its mount has it look.
///
/// Between two of its scans a ring turns several times, which are measured as if from about the
/// same place: a scan stands for the piece of the way that it is in the middle of. What a line or a
/// rosette measures there is simulated shot by shot, each from where it is flown.
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
#include "missions/config/mission.h"
#include "missions/config/scanner_field.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::config {

/// The turns of one scan are measured from places that are at most half of this from its own, along
/// the axis [m].
inline constexpr double spread_of_turns = 0.25;

/// How often a scanner turns in one of its scans: once, or in flight all the time between two.
std::size_t turns_of(const config::SensorConfig& sensor);

/// The scanner that `sensor.lidar` names, a path being relative to `folder`. Throws what
/// find_sensor() throws, and Error{bad_config} if the description is a camera's.
sim::LidarConfig read_scanner(const std::string& name, const std::filesystem::path& folder);

/// The camera that stands for the scanner when views are chosen, as it is carried. A line's is
/// about as dense as its rays until it is known how fast it flies. Throws what forward_camera()
/// throws.
sim::DepthCameraConfig planning_camera(const config::SensorConfig& sensor);

/// What a rosette that is flown draws in one of its scans, in its planning camera's frame.
RosetteField rosette_of(const config::SensorConfig& sensor);

/// Of angles about the x, then the y, then the z axis, as missions give them [rad].
Eigen::Quaterniond rotation_of(const Eigen::Vector3d& angles);

/// How the scanner sits on its carrier, body_from_sensor, as `scan.mount` says.
Eigen::Isometry3d mount_of(const config::ScanConfig& scan);

/// Of a scanner so fixed to the airframe: a ring or a line looks to the left of its axis, level; a
/// rosette along its x axis.
config::ScannerMount scanner_mount(const sim::LidarConfig& lidar,
                                   const Eigen::Isometry3d& body_from_scanner);

/// Where the vehicle's nose points at a view of a scanner, level; and where the scanner looks for a
/// nose.
geometry::View nose_view(const config::ScannerMount& mount, const geometry::View& view);
geometry::View scanner_view(const config::ScannerMount& mount, const geometry::View& nose);

/// A piece of way on which a scan is measured, flown evenly.
struct Stretch {
  geometry::View from, to;  ///< of the vehicle, its nose level
  double duration = 0.0;    ///< [s]
};

/// How a sensor is really carried, beside the view that it is believed to have.
struct Carriage {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();      ///< of its place [m]
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();       ///< small angles about world axes [rad]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();   ///< amid the scan [m/s]
  Eigen::Vector3d turn_rate = Eigen::Vector3d::Zero();  ///< about world axes [rad/s]
  int instants = 0;  ///< that stand for a camera's exposure; zero: it stands meanwhile
  /// Where a scanner is believed to be meanwhile; none: it stands. A ring's turns are measured from
  /// about one place all the same.
  std::optional<Stretch> stretch;

  bool is_exact() const { return turn.isZero(0.0) && shift.isZero(0.0); }

  /// The true pose where this one is believed.
  Eigen::Isometry3d true_pose(const Eigen::Isometry3d& believed) const;
};

/// Immutable; safe to use from any number of threads.
class SurveySensor {
 public:
  /// Throws what the sensor's configuration throws when it is not valid.
  SurveySensor(const config::SensorConfig& config, std::uint64_t seed);

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
  void measure_way(const sim::Lidar& lidar, const sim::Scene& scene, const geometry::View& view,
                   const Carriage& carriage, std::uint64_t frame, unsigned threads,
                   std::vector<Eigen::Vector3f>& points) const;

  std::variant<sim::DepthCamera, sim::Lidar> sensor_;
  flight::Shutter shutter_;
  ScannerKind kind_ = ScannerKind::ring;
  std::optional<config::ScannerMount> mount_;  ///< of a scanner that is flown
  std::size_t turns_ = 1;                      ///< of a ring that make a scan
  double period_ = rosette_period;             ///< of other scanners' scans
};

}  // namespace skycap::missions::config
