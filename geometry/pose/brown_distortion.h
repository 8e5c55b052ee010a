/// Lens distortion after Brown and Conrady on the normalised image plane.
///
/// Source: Brown, Close-Range Camera Calibration, 1971, in the form used by OpenCV and by COLMAP's
/// model FULL_OPENCV.
#pragma once

#include <Eigen/Core>

#include "geometry/pose/photo_camera.h"

namespace skycap::geometry {

/// Applies the distortion to a point with undistorted coordinates `slope` (x/z and y/z in the
/// camera frame). Returns its coordinates on the normalised image plane.
Eigen::Vector2d distort(const BrownDistortion& intrinsics, const Eigen::Vector2d& slope);

/// Removes the distortion: inverse of distort() within 1e-12, by fixed-point iteration. Where
/// distort() is not one-to-one, returns the last iterate, which may be inexact.
Eigen::Vector2d undistort(const BrownDistortion& intrinsics, const Eigen::Vector2d& distorted);

}  // namespace skycap::geometry
