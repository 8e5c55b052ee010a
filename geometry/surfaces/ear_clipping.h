/// Polygons of one ring, cut into triangles of their own corners: faces of mesh files, footprints,
/// walls of models. Polygons with holes, which need more: polygon_triangulation.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

/// Cuts a counter-clockwise polygon of at least three corners into counter-clockwise triangles,
/// given by indices of its corners. Corners within a straight side and repeated corners, as of
/// bridges to holes, are allowed. A polygon that crosses itself is cut into as many triangles, some
/// of them clockwise. Takes the roundest ear first; O(n^2) for usual polygons, O(n^3) at worst.
std::vector<std::array<std::uint32_t, 3>> clip_ears(std::span<const Eigen::Vector2d> polygon);

}  // namespace skycap::geometry
