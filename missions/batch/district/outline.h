/// The shape of a building on a map.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::missions::batch {

using Ring = std::vector<Eigen::Vector2d>;

/// The rings around its lowest level faces, holes among them; where they do not close, the convex
/// hull of all of it.
std::vector<Ring> outline_of(const geometry::Mesh& mesh);

/// The corners of the smallest convex shape around places, counter-clockwise.
Ring convex_hull(std::vector<Eigen::Vector2d> places);

}  // namespace skycap::missions::batch
