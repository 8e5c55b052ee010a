/// Field of view of a laser scanner: equivalent cameras for view selection, and the ray spacing.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "sim/sensors/depth_camera.h"
#include "sim/sensors/sensor.h"

namespace skycap::sim {

enum class ScannerKind {
  ring,  ///< Several lasers rotate around an axis. Each revolution covers a ring, or part of one.
  line,  ///< One rotating laser. Each revolution covers a line, so an area requires flight.
  rosette,  ///< Prisms create a non-repeating pattern in a round field around x.
};

/// Returns the kind of a scanner. Throws Error{bad_config} if the scanner neither rotates nor has
/// prisms.
ScannerKind find_scanner_kind(const LidarConfig& lidar);

/// Elevation range of a rotating scanner's lasers [rad].
struct Elevations {
  double min_elevation, max_elevation;
};
Elevations elevations(const LidarConfig& lidar);

/// Returns the rotation angle between two firings [rad].
double azimuth_step(const LidarConfig& lidar);

/// Measuring time of a rosette scanner at rest [s].
inline constexpr double rosette_period = 0.5;

/// Returns the pinhole camera that approximates a scanner that stops at views. It covers the
/// forward quarter revolution of a ring, or a rosette within rosette_period, with one pixel per
/// ray. Throws the same errors as find_scanner_kind(), and Error{bad_config} for a single-line
/// scanner.
DepthCameraConfig forward_camera(const LidarConfig& lidar);

/// Returns the pinhole camera for the sideways quarter revolution of a ring with a level axis. Its
/// width is the symmetric spread of the lasers. The number of pixels is that of rays in `turns`
/// revolutions.
DepthCameraConfig side_camera(const LidarConfig& lidar, std::size_t turns = 1);

/// Returns the pinhole camera that approximates a single-line scanner flown along its axis. The
/// width covers the distance flown in `period` [s] at the view distance, with one column per line.
/// The height covers a quarter revolution. Consecutive images then contain the correct number of
/// rays for surfaces at any distance. `swept` is the distance flown in the period, divided by the
/// view distance.
DepthCameraConfig line_camera(const LidarConfig& lidar, double period, double swept);

/// Coverage of a rosette within some time.
struct RosetteField {
  /// Tangents of the half angles, horizontal and vertical, of a fully covered rectangle.
  Eigen::Vector2d half_slopes;
  std::size_t rays;  ///< Number of rays in the rectangle.
  /// Cell size in azimuth and elevation around the image's x axis at which 99.5% of the cells
  /// contain a ray [rad].
  double gap;
};

/// Computes the coverage within `period` [s] in an image with the given rotation from the scanner's
/// frame to the optical frame.
RosetteField rosette_field(const LidarConfig& lidar, double period,
                           const Eigen::Matrix3d& optical_from_scanner);

/// Returns the pinhole camera for that rectangle, with one pixel per ray.
DepthCameraConfig rosette_camera(const LidarConfig& lidar, const RosetteField& field);

/// Returns the maximum angle between neighbouring rays in one revolution of a ring [rad].
double ray_spacing(const LidarConfig& lidar);

/// Returns the standard deviation of a range at normal incidence [m].
double range_noise(const LidarConfig& lidar, double range);

}  // namespace skycap::sim
