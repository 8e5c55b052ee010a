/// Triangulation of polygons without holes, without additional vertices: faces of mesh files,
/// footprints, and walls of models. For polygons with holes, see polygon_triangulation.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

/// Cuts a counter-clockwise polygon of at least three corners into counter-clockwise triangles of
/// corner indices. Collinear and repeated corners, such as those of bridges to holes, are allowed.
/// For a self-intersecting polygon, the number of triangles is the same, but some are clockwise.
/// The roundest ear is cut first. Complexity: O(n^2) for typical polygons, O(n^3) in the worst
/// case.
std::vector<std::array<std::uint32_t, 3>> clip_ears(std::span<const Eigen::Vector2d> polygon);

}  // namespace skycap::geometry
