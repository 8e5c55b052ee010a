/// Outlines of buildings on a map.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::missions::batch {

using Ring = std::vector<Eigen::Vector2d>;

/// Returns the boundary rings of the lowest horizontal faces, including holes. If they are not
/// closed, returns the convex hull of the whole mesh.
std::vector<Ring> compute_outline(const geometry::Mesh& mesh);

/// Computes the corners of the convex hull of positions, counter-clockwise.
Ring convex_hull(std::vector<Eigen::Vector2d> positions);

}  // namespace skycap::missions::batch
