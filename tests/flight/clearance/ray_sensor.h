/// Brute-force depth camera and LiDAR for small meshes: ground truth for tests of conclusions from
/// measurements.
#pragma once

#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight {

/// Casts one noise-free ray through each pixel.
geometry::Scan depth_image(const geometry::Mesh& scene, const geometry::Camera& camera,
                           const geometry::View& view);

/// Casts noise-free rays in all directions, one for each `spacing` [rad] of azimuth and elevation.
geometry::Scan scan_around(const geometry::Mesh& scene, const Eigen::Vector3d& position,
                           double spacing);

}  // namespace skycap::flight
