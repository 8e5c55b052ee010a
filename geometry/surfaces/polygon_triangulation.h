/// Triangulation of planar polygons with holes, as in city models and maps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

/// Adds the triangles of a polygon to `mesh` and returns their number. Ring i consists of the
/// corners [begin[i], begin[i + 1]). The plane is orthogonal to the area vector of the first ring
/// (Newell's normal), and the triangles have the orientation of the first ring.
///
/// The even-odd rule defines the inside, independent of the orientation of the other rings: a ring
/// within the first is a hole. Rings may repeat their first corner at the end, touch, or cross;
/// each crossing adds a vertex. Returns zero if the first ring has no area or a corner is not
/// finite.
std::size_t add_polygon(Mesh& mesh, std::span<const Eigen::Vector3d> corners,
                        std::span<const std::uint32_t> begin);

}  // namespace skycap::geometry
