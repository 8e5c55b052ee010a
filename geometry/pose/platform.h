/// Mounting of a sensor on the vehicle, and exposure timing of a camera.
///
/// Body frame: x forward, y left, z up. The vehicle is assumed to stay level.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/pose/pose.h"

namespace skycap::geometry {

/// Exposure timing of an image.
struct Shutter {
  double exposure = 0.0;  ///< exposure time of each pixel [s]
  double readout =
      0.0;  ///< time between the exposures of the first and the last row [s]; zero: global shutter
};

/// Mounting of a laser scanner on the vehicle.
struct ScannerMount {
  Eigen::Isometry3d body_from_scanner = Eigen::Isometry3d::Identity();
  double view_azimuth =
      0.0;  ///< azimuth of the view direction, counter-clockwise from the nose [rad]
  double view_pitch = 0.0;  ///< pitch of a scanner with a single view direction [rad]
};

/// Straight path segment, flown at constant speed, on which a scan is measured.
struct Stretch {
  View from, to;          ///< vehicle poses with a level nose
  double duration = 0.0;  ///< [s]
};

/// Returns the rotation composed of rotations about the x, then the y, then the z axis. `angles`
/// are those of mission files [rad].
Eigen::Quaterniond make_rotation(const Eigen::Vector3d& angles);

/// Converts a view of the scanner to the level view of the vehicle's nose, or vice versa.
View nose_view(const ScannerMount& mount, const View& view);
View scanner_view(const ScannerMount& mount, const View& nose);

}  // namespace skycap::geometry
