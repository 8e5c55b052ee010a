/// Flat polygons with holes, cut into triangles: what city models and maps are made of.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

/// Adds to `mesh` the triangles of the polygon whose rings are `corners` [begin[i], begin[i + 1]),
/// on the plane of the first ring's area vector (Newell's normal) and turned as the first ring is.
/// What an odd number of rings surrounds is inside, whichever way the others turn: a ring within
/// the first is a hole. Rings may repeat their first corner at the end, touch, or cross: a crossing
/// adds a vertex. The number of triangles added; zero if the first ring has no area or a corner is
/// not finite.
std::size_t add_polygon(Mesh& mesh, std::span<const Eigen::Vector3d> corners,
                        std::span<const std::uint32_t> begin);

}  // namespace skycap::geometry
