/// Simulated sensor of a survey: a depth camera or a laser scanner.
///
/// The scan of a scanner has points but no pixels. A hand-held scanner is stationary at each view.
/// A ring makes one revolution with the middle of its lasers, at azimuth zero, along the view
/// direction. A rosette looks along it for rosette_period.
///
/// A mounted scanner is fixed to a level airframe, and a view defines the heading of the nose. The
/// axis of a ring or a line is level, too. The view direction is any direction in the plane of its
/// rotation, to the left of the axis. A rosette looks in the direction of its mount.
///
/// Between two scans, a ring makes several revolutions, which are simulated from approximately one
/// position. Each scan represents the part of the path around it. Pulses of a line or a rosette are
/// simulated individually along the path.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/points/scan.h"
#include "geometry/pose/platform.h"
#include "geometry/pose/pose.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "sim/sensors/lidar.h"
#include "sim/sensors/navigation_errors.h"
#include "sim/sensors/scanner_field.h"

namespace skycap::sim {

/// Length along the axis over which the revolutions of one scan are distributed, centred at the
/// scan position [m].
inline constexpr double revolution_spread = 0.25;

/// Capture mode of a survey.
enum class Capture {
  stops,   ///< Stationary, at views.
  moving,  ///< At views and en route.
};

/// Options of the survey's sensor: a depth camera, or a laser scanner.
struct SurveySensorOptions {
  /// Depth camera, or the camera by which planners select views for a scanner, see
  /// planning_camera(). The survey provides its noise seed.
  DepthCameraConfig camera = d435();
  std::optional<LidarConfig> scanner;  ///< Laser scanner. The survey provides its seed.
  /// Mount on a vehicle. Without a mount, the scanner can look in any direction.
  std::optional<geometry::ScannerMount> mount;
  geometry::Shutter shutter{.exposure = 0.01, .readout = 0.0};
  double settle = 0.0;  ///< Rest time of the sensor before an exposure [s].
  Capture capture = Capture::stops;
  double frame_period = 1.0;    ///< Interval between en-route scans [s].
  NavigationErrors navigation;  ///< Navigation errors of the vehicle. The survey provides the seed.

  bool is_moving() const { return capture == Capture::moving; }
  /// Returns true if a laser scanner measures continuously, so that the vehicle need not hold at
  /// views.
  bool scans_in_flight() const { return mount && is_moving(); }
};

/// Returns the number of revolutions per scan: one, or in flight all revolutions between two scans.
std::size_t count_revolutions(const SurveySensorOptions& sensor);

/// Returns the field of one scan of a mounted rosette scanner, in the frame of its planning camera.
/// Returns std::nullopt for other scanners. Takes tenths of a second.
std::optional<RosetteField> compute_rosette_field(const SurveySensorOptions& sensor);

/// Returns the camera that approximates the mounted or hand-held scanner for view selection.
/// `rosette` is compute_rosette_field(sensor). For a single-line scanner, the pixel density is that
/// of its rays until the speed is known. Throws the same errors as forward_camera().
DepthCameraConfig planning_camera(const SurveySensorOptions& sensor,
                                  const std::optional<RosetteField>& rosette);

/// Interval between two scans of a mounted scanner in flight, each of which represents the
/// revolutions around it [s].
inline constexpr double scanner_period = 0.5;

/// Returns the maximum speed for the required point density [m/s]. Points on a wall at `distance`
/// [m] must be at most `spacing` [m] apart. The density is doubled in each direction unless the
/// lines are even. The speed is limited to half of `fastest`, the vehicle's maximum [m/s].
double scanning_speed(const SurveySensorOptions& sensor, double distance, double spacing,
                      double fastest);

/// Returns the mount of a scanner that is fixed to the airframe. A ring or a line looks level, to
/// the left of its axis. A rosette looks along its x axis.
geometry::ScannerMount scanner_mount(const LidarConfig& lidar,
                                     const Eigen::Isometry3d& body_from_scanner);

/// True motion of a sensor relative to its estimated view.
struct PlatformMotion {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< Position error [m].
  /// Small rotation angles around the world axes [rad].
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  /// Velocity at the middle of the scan [m/s].
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  /// Angular rate around the world axes [rad/s].
  Eigen::Vector3d turn_rate = Eigen::Vector3d::Zero();
  int instants = 0;  ///< Number of instants that sample a camera's exposure. 0: stationary.
  /// Estimated path of a scanner during the scan. Empty: stationary. The revolutions of a ring are
  /// always measured from approximately one position.
  std::optional<geometry::Stretch> stretch;

  bool is_exact() const { return turn.isZero(0.0) && shift.isZero(0.0); }

  /// Returns the true pose for an estimated pose.
  Eigen::Isometry3d true_pose(const Eigen::Isometry3d& estimated) const;
};

/// Immutable and thread-safe.
class SurveySensor {
 public:
  /// Throws if the sensor configuration is invalid.
  SurveySensor(const SurveySensorOptions& config, std::uint64_t seed);

  /// Returns the scan from `view` in its optical frame (geometry::camera_pose()). Seed and `frame`
  /// determine the noise. The result does not depend on `threads` (0: all processors). Reuses the
  /// memory of `buffer`.
  geometry::Scan scan(const Scene& scene, const geometry::View& view, std::uint64_t frame,
                      unsigned threads, geometry::Scan buffer = {}) const;

  /// Returns the scan of a sensor with the given motion. Points are relative to the estimated pose.
  /// The velocity of a scanner is ignored, because its revolutions are measured from approximately
  /// one position.
  geometry::Scan scan(const Scene& scene, const geometry::View& view,
                      const PlatformMotion& platform_motion, std::uint64_t frame, unsigned threads,
                      geometry::Scan buffer = {}) const;

 private:
  std::vector<Eigen::Isometry3d> turns(const geometry::View& view) const;
  void measure_en_route(const Lidar& lidar, const Scene& scene, const geometry::View& view,
                        const PlatformMotion& platform_motion, std::uint64_t frame,
                        unsigned threads, std::vector<Eigen::Vector3f>& points) const;

  std::variant<DepthCamera, Lidar> sensor_;
  geometry::Shutter shutter_;
  ScannerKind kind_ = ScannerKind::ring;
  std::optional<geometry::ScannerMount> mount_;  ///< Mount of a scanner on a vehicle.
  std::size_t turns_ = 1;                        ///< Number of revolutions of a ring per scan.
  double period_ = rosette_period;               ///< Duration of a scan of other scanners [s].
};

}  // namespace skycap::sim
