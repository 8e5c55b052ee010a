#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_cloud.h"

namespace skycap::missions::package {

/// For each point the unit normal of the plane through the points within `radius`, on the side of
/// the sensor that took the point; `sensors` are the views' positions. Where there are too few
/// neighbours for a plane it is the direction to the sensor. Of a dense cloud, points a quarter of
/// the radius apart are enough for the plane. Empty if a stop is requested before all are found.
std::vector<Eigen::Vector3f> cloud_normals(const geometry::PointCloud& cloud,
                                           std::span<const Eigen::Vector3d> sensors, double radius,
                                           unsigned threads, const std::stop_token& stop = {});

}  // namespace skycap::missions::package
