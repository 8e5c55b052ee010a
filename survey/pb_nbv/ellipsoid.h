/// Ellipsoids around clusters of voxels, and their images.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "survey/pb_nbv/pb_nbv_config.h"

namespace skycap::survey::pb_nbv {

/// Set of points c + S^(1/2) u with |u| <= 1.
struct Ellipsoid {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d shape = Eigen::Matrix3d::Identity();  ///< S, squared semi-axes [m^2]
};

/// Returns an ellipsoid that contains all points and whose volume is near the minimum, to a ratio
/// of 1.01 in Khachiyan's criterion (Mathematics of Operations Research 21, 1996). Returns nullopt
/// if the points are in a plane.
std::optional<Ellipsoid> enclose(std::span<const Eigen::Vector3d> points);

/// Image at which scores are counted, a reduced image of the sensor.
struct ScoreImage {
  Eigen::Matrix3d calibration = Eigen::Matrix3d::Identity();  ///< K [px]
  int width = 0;                                              ///< [px]
  int height = 0;                                             ///< [px]
};

/// Returns the number of pixel centres of the image inside the projected ellipsoid. Zero if its
/// centre is behind the camera, the camera is inside it, or its outline is not an ellipse.
/// Reading::released rounds the outline as the released code does: the semi-axes are computed with
/// the angle of the ellipse in degrees taken for radians.
std::size_t count_pixels(const Ellipsoid& ellipsoid, const Eigen::Isometry3d& camera_from_world,
                         const ScoreImage& image, Reading reading);

}  // namespace skycap::survey::pb_nbv
