/// How a vehicle carries a sensor that is fixed to it, and when a camera exposes its images.
///
/// Body frame: x forward, y left, z up. The vehicle keeps level.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/place/pose.h"

namespace skycap::geometry {

/// When a sensor takes its pictures.
struct Shutter {
  double exposure = 0.0;  ///< of each pixel [s]
  double readout = 0.0;   ///< from the first row's exposure to the last one's [s]; zero: global
};

/// How a laser scanner is fixed to the vehicle that carries it.
struct ScannerMount {
  Eigen::Isometry3d body_from_scanner = Eigen::Isometry3d::Identity();
  double look_azimuth = 0.0;  ///< where its views look, anticlockwise from the nose [rad]
  double look_pitch = 0.0;    ///< of a scanner that looks one way only [rad]
};

/// A piece of way on which a scan is measured, flown evenly.
struct Stretch {
  View from, to;          ///< of the vehicle, its nose level
  double duration = 0.0;  ///< [s]
};

/// Of angles about the x, then the y, then the z axis, as missions give them [rad].
Eigen::Quaterniond rotation_of(const Eigen::Vector3d& angles);

/// Where the vehicle's nose points at a view of a scanner, level; and where the scanner looks for a
/// nose.
View nose_view(const ScannerMount& mount, const View& view);
View scanner_view(const ScannerMount& mount, const View& nose);

}  // namespace skycap::geometry
