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
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/place/platform.h"
#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "sim/sensors/lidar.h"
#include "sim/sensors/navigation_errors.h"
#include "sim/sensors/scanner_field.h"

namespace skycap::sim {

/// The turns of one scan are measured from places that are at most half of this from its own, along
/// the axis [m].
inline constexpr double spread_of_turns = 0.25;

/// Where a sensor takes its scans while a survey is flown.
enum class Capture {
  stops,   ///< at the views, at rest
  moving,  ///< and on the ways between them
};

/// What a survey measures with: a depth camera, or a laser scanner in its place.
struct SurveySensorOptions {
  /// The camera itself; of a scanner the camera by which planners choose its views, see
  /// planning_camera(). The seed of its noise is the survey's.
  DepthCameraConfig camera = d435();
  std::optional<LidarConfig> scanner;  ///< its seed is the survey's
  std::optional<geometry::ScannerMount>
      mount;  ///< of a scanner that is flown; others look anywhere
  geometry::Shutter shutter{.exposure = 0.01, .readout = 0.0};
  double settle = 0.0;  ///< at rest before a picture, for the sensor's own sake [s]
  Capture capture = Capture::stops;
  double frame_period = 1.0;    ///< between the scans that are taken on the way [s]
  NavigationErrors navigation;  ///< of the vehicle that carries it; its seed is the survey's

  bool is_moving() const { return capture == Capture::moving; }
  /// Whether a laser scanner measures all the way, so that nothing is waited for at views.
  bool scans_in_flight() const { return mount && is_moving(); }
};

/// How often a scanner turns in one of its scans: once, or in flight all the time between two.
std::size_t turns_of(const SurveySensorOptions& sensor);

/// Field of one scan of a flown rosette scanner, in the frame of its planning camera; nothing for
/// other scanners. Takes some tenths of a second to compute.
std::optional<RosetteField> flown_rosette(const SurveySensorOptions& sensor);

/// Camera that stands for the mounted or hand-held scanner when views are chosen; `rosette` is
/// flown_rosette(sensor). The camera of a single-line scanner is about as dense as its rays until
/// its speed is known. Throws what forward_camera() throws.
DepthCameraConfig planning_camera(const SurveySensorOptions& sensor,
                                  const std::optional<RosetteField>& rosette);

/// Between two scans of a scanner in flight, each of which stands for the turns around it [s].
inline constexpr double scanner_period = 0.5;

/// As fast as a scanner's points on a wall at `distance` are still as dense as they are stored,
/// `spacing` apart, twice over each way unless they are even lines; no faster than half of what the
/// vehicle can, `fastest` [m/s].
double scanning_speed(const SurveySensorOptions& sensor, double distance, double spacing,
                      double fastest);

/// Of a scanner so fixed to the airframe: a ring or a line looks to the left of its axis, level; a
/// rosette along its x axis.
geometry::ScannerMount scanner_mount(const LidarConfig& lidar,
                                     const Eigen::Isometry3d& body_from_scanner);

/// How a sensor is really carried, beside the view that it is believed to have.
struct Carriage {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();      ///< of its place [m]
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();       ///< small angles about world axes [rad]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();   ///< amid the scan [m/s]
  Eigen::Vector3d turn_rate = Eigen::Vector3d::Zero();  ///< about world axes [rad/s]
  int instants = 0;  ///< that stand for a camera's exposure; zero: it stands meanwhile
  /// Where a scanner is believed to be meanwhile; none: it stands. A ring's turns are measured from
  /// about one place all the same.
  std::optional<geometry::Stretch> stretch;

  bool is_exact() const { return turn.isZero(0.0) && shift.isZero(0.0); }

  /// The true pose where this one is believed.
  Eigen::Isometry3d true_pose(const Eigen::Isometry3d& believed) const;
};

/// Immutable; safe to use from any number of threads.
class SurveySensor {
 public:
  /// Throws what the sensor's configuration throws when it is not valid.
  SurveySensor(const SurveySensorOptions& config, std::uint64_t seed);

  /// What is measured from `view`, in its optical frame (geometry::camera_pose()). With the seed,
  /// `frame` alone decides the noise; the result does not depend on `threads` (zero: all
  /// processors). The memory of `recycled` is used again.
  geometry::Scan scan(const Scene& scene, const geometry::View& view, std::uint64_t frame,
                      unsigned threads, geometry::Scan recycled = {}) const;

  /// The same by a sensor that is carried so: its points are where they are thought to be. A
  /// scanner's velocity is not looked at, since its turns are measured from about one place.
  geometry::Scan scan(const Scene& scene, const geometry::View& view, const Carriage& carriage,
                      std::uint64_t frame, unsigned threads, geometry::Scan recycled = {}) const;

 private:
  std::vector<Eigen::Isometry3d> turns(const geometry::View& view) const;
  void measure_way(const Lidar& lidar, const Scene& scene, const geometry::View& view,
                   const Carriage& carriage, std::uint64_t frame, unsigned threads,
                   std::vector<Eigen::Vector3f>& points) const;

  std::variant<DepthCamera, Lidar> sensor_;
  geometry::Shutter shutter_;
  ScannerKind kind_ = ScannerKind::ring;
  std::optional<geometry::ScannerMount> mount_;  ///< of a scanner that is flown
  std::size_t turns_ = 1;                        ///< of a ring that make a scan
  double period_ = rosette_period;               ///< of other scanners' scans
};

}  // namespace skycap::sim
