/// What a laser scanner sees, by its description: the cameras that stand for it when views are
/// chosen, and how far apart its rays are.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "sim/sensors/depth_camera.h"
#include "sim/sensors/sensor.h"

namespace skycap::sim {

enum class ScannerKind {
  ring,     ///< several lasers turn about an axis: each turn sees a ring, or part of one
  line,     ///< one laser does: each turn sees a line, and only flying makes a field of lines
  rosette,  ///< prisms draw a pattern over a round field about x that does not repeat
};

/// Throws Error{bad_config} if the scanner neither spins nor has prisms.
ScannerKind kind_of(const LidarConfig& lidar);

/// Of a spinning scanner's lasers [rad].
struct Elevations {
  double lowest, highest;
};
Elevations elevations(const LidarConfig& lidar);

/// Angle that a scanner turns between two firings [rad].
double azimuth_step(const LidarConfig& lidar);

/// A rosette is looked at for so long by a scanner that stands [s].
inline constexpr double rosette_period = 0.5;

/// The pinhole camera that stands for a scanner that stops at its views: it sees what a ring does
/// in the quarter turn before it, or a rosette all over in rosette_period, with as many pixels as
/// rays are sent there. Throws what kind_of() throws, and Error{bad_config} for a line.
DepthCameraConfig forward_camera(const LidarConfig& lidar);

/// The pinhole camera that sees the quarter turn to the side of a ring whose axis is level: as
/// wide as the lasers spread to either side, with as many pixels as rays are sent there in so many
/// turns.
DepthCameraConfig side_camera(const LidarConfig& lidar, std::size_t turns = 1);

/// The pinhole camera that stands for a line which is flown along its axis: as wide as what it
/// sweeps in a period, seen from the view distance, with a column to each line; a quarter turn
/// high. Looks at what is flown past one after the other then add up to the rays that it gets,
/// however far away it is. `way` is what is flown in the period, as a share of the view distance.
DepthCameraConfig line_camera(const LidarConfig& lidar, double period, double way);

/// What a rosette draws in some time.
struct RosetteField {
  Eigen::Vector2d half_slopes;  ///< tangents of half a rectangle's angles, wide and high, in which
                                ///< it shoots everywhere
  std::size_t rays;             ///< that go there
  double gap;  ///< cells so wide in azimuth and elevation about the image's x axis hold a ray each,
               ///< but for one in two hundred [rad]
};

/// In an image whose optical frame is turned so against the scanner's.
RosetteField rosette_field(const LidarConfig& lidar, double period,
                           const Eigen::Matrix3d& optical_from_scanner);

/// The pinhole camera of that rectangle, with a pixel to each ray.
DepthCameraConfig rosette_camera(const LidarConfig& lidar, const RosetteField& field);

/// The greatest angle between neighbouring rays of one turn of a ring [rad].
double ray_spacing(const LidarConfig& lidar);

/// Standard deviation of a range, head-on [m].
double range_noise(const LidarConfig& lidar, double range);

}  // namespace skycap::sim
