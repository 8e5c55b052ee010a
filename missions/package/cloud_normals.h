#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_cloud.h"

namespace skycap::missions::package {

/// Computes unit normals of the cloud's points, oriented towards the sensor that measured them.
/// `sensors` contains the positions of the views. Each normal is that of a plane fitted to the
/// neighbours within `radius` [m]. In dense clouds, the fit uses neighbours at a spacing of a
/// quarter of the radius. With fewer than three neighbours, the normal is the direction to the
/// sensor. Returns an empty list if a stop is requested before completion.
std::vector<Eigen::Vector3f> cloud_normals(const geometry::PointCloud& cloud,
                                           std::span<const Eigen::Vector3d> sensors, double radius,
                                           unsigned threads, const std::stop_token& stop = {});

}  // namespace skycap::missions::package
