/// A depth camera and a LiDAR over a few triangles, by brute force: truth for tests of what may be
/// concluded from measurements.
#pragma once

#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight {

/// One noise-free ray through every pixel.
geometry::Scan depth_image(const geometry::Mesh& scene, const geometry::Camera& camera,
                           const geometry::View& view);

/// One noise-free ray every `spacing` [rad] of azimuth and elevation, all around.
geometry::Scan scan_around(const geometry::Mesh& scene, const Eigen::Vector3d& position,
                           double spacing);

}  // namespace skycap::flight
