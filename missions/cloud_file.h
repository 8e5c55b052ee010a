/// The cloud of a mission package: points with normals and the view that each was taken from.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/point_cloud.h"

namespace skycap::missions {

/// For each point the unit normal of the plane through the points within `radius`, on the side of
/// the sensor that took the point; `sensors` are the views' positions. Where there are too few
/// neighbours for a plane it is the direction to the sensor. Of a dense cloud, points a quarter of
/// the radius apart are enough for the plane.
std::vector<Eigen::Vector3f> cloud_normals(const geometry::PointCloud& cloud,
                                           std::span<const Eigen::Vector3d> sensors, double radius,
                                           unsigned threads);

/// Writes binary little-endian PLY: float x y z nx ny nz, uint view. Throws Error{bad_file} if the
/// file cannot be written whole.
void write_cloud_file(const std::filesystem::path& file, const geometry::PointCloud& cloud,
                      std::span<const Eigen::Vector3f> normals);

}  // namespace skycap::missions
