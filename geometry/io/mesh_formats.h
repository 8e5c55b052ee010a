/// The parsers behind read_mesh(), one for each format; for the sources of mesh_io and their tests.
/// Each takes a file's name (which opens every message) and its bytes, and throws Error{bad_file}.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "geometry/error.h"
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

/// A mesh without polygons that have a corner which is not finite, and how many there were.
std::size_t drop_infinite_polygons(PolygonSoup& soup);

/// The polygons cut into triangles of the same orientation, along the plane they are nearest to;
/// polygons of fewer than three corners are left out. Throws Error{bad_file} if a polygon has a
/// corner that is not finite, or is not convex and has more than 1000 corners.
Mesh triangulate(std::string_view name, PolygonSoup soup);

/// Throws Error{bad_file} in one line that begins with the name.
[[noreturn]] inline void fail_mesh(std::string_view name, const std::string& what) {
  throw Error(ErrorKind::bad_file, std::string(name) + ": " + what);
}

inline std::string no_such_vertex(std::int64_t vertex, std::size_t count) {
  return "has vertex " + std::to_string(vertex) + ", but there are " + std::to_string(count) +
         " vertices, counted from 0";
}

/// Polygons that do not grow past the limits.
class BoundedSoup {
 public:
  BoundedSoup(std::string_view name, const MeshLimits& limits) : name_(name), limits_(limits) {}

  const PolygonSoup& soup() const { return soup_; }
  PolygonSoup& soup() { return soup_; }

  /// What a file promises, before memory is taken for it.
  void require(std::uint64_t vertices, std::uint64_t faces) const {
    if (vertices > limits_.vertices || faces > limits_.faces) fail_of_size();
  }

  void add_vertex(const Eigen::Vector3d& vertex) {
    if (soup_.vertices.size() == limits_.vertices) fail_of_size();
    soup_.vertices.push_back(vertex);
  }

  /// Of the polygon that is closed next.
  void add_corner(std::uint32_t vertex) {
    if (soup_.corners.size() == limits_.corners) fail_of_size();
    if (soup_.corners.size() - soup_.polygon_begin.back() == limits_.face_corners) {
      fail_mesh(name_, "face " + std::to_string(soup_.polygon_begin.size() - 1) +
                           " has more than " + std::to_string(limits_.face_corners) +
                           " corners; triangulate it first");
    }
    soup_.corners.push_back(vertex);
  }

  void close_polygon() {
    if (soup_.polygon_begin.size() > limits_.faces) fail_of_size();
    soup_.polygon_begin.push_back(soup_.corners.size());
  }

 private:
  [[noreturn]] void fail_of_size() const {
    fail_mesh(name_, "contains more than " + std::to_string(limits_.faces) + " faces, " +
                         std::to_string(limits_.corners) + " corners of faces or " +
                         std::to_string(limits_.vertices) + " vertices; simplify the mesh");
  }

  std::string_view name_;
  MeshLimits limits_;
  PolygonSoup soup_;
};

}  // namespace skycap::geometry
