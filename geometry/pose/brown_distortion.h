/// Lens distortion of Brown and Conrady on the normalised image plane.
///
/// Source: Brown, Close-Range Camera Calibration, 1971, in the form of OpenCV and of COLMAP's model
/// FULL_OPENCV.
#pragma once

#include <Eigen/Core>

#include "geometry/pose/photo_camera.h"

namespace skycap::geometry {

/// Where a point at `slope` (x/z and y/z in the camera frame) appears on the normalised image
/// plane: its slope through a pinhole camera.
Eigen::Vector2d distort(const BrownDistortion& intrinsics, const Eigen::Vector2d& slope);

/// The slope that appears at `distorted`: inverse of distort() within 1e-12, by fixed-point
/// iteration. Exact only where distort() maps slopes one to one; elsewhere the last iterate.
Eigen::Vector2d undistort(const BrownDistortion& intrinsics, const Eigen::Vector2d& distorted);

}  // namespace skycap::geometry
