/// The parsers behind read_mesh(), one for each format; for the sources of mesh_io and their tests.
/// Each takes a file's name (which opens every message) and its bytes, and throws Error{bad_file}.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

/// How large a mesh in a file may be; tests want it smaller.
struct MeshLimits {
  std::size_t faces = 40'000'000;
  std::size_t vertices = 120'000'000, corners = 120'000'000;  ///< corners: of all faces
  std::size_t face_corners = 1'000'000;                       ///< of one
  std::size_t materials = 1'000'000;
};

/// Polygons as a file lists them: nothing of it is checked but that indices are those of vertices.
struct PolygonSoup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::uint32_t> corners;         ///< vertex indices of all polygons
  std::vector<std::size_t> polygon_begin{0};  ///< polygon i is corners [begin[i], begin[i + 1])
  std::vector<std::string> materials;  ///< names; empty: the file has none, or it is not an OBJ
  std::vector<std::uint32_t> polygon_materials;  ///< of each polygon, if there are materials
};

PolygonSoup parse_ply(std::string_view name, std::string_view bytes, const MeshLimits& limits = {});
PolygonSoup parse_obj(std::string_view name, std::string_view text, const MeshLimits& limits = {});
PolygonSoup parse_off(std::string_view name, std::string_view text, const MeshLimits& limits = {});
/// Ascii or binary.
PolygonSoup parse_stl(std::string_view name, std::string_view bytes, const MeshLimits& limits = {});

/// The polygons cut into triangles of the same orientation, along the plane they are nearest to;
/// polygons of fewer than three corners are left out. Throws Error{bad_file} if a polygon has a
/// corner that is not finite, or is not convex and has more than 1000 corners.
Mesh triangulate(std::string_view name, PolygonSoup soup);

}  // namespace skycap::geometry
