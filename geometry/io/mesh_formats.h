/// Parsers of the formats of read_mesh(), for the sources of mesh_io and their tests. Each parser
/// reads the bytes of a file and throws Error{bad_file}. Every message begins with the file name.
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

/// Maximum sizes of a mesh in a file. Tests use smaller limits.
struct MeshLimits {
  std::size_t faces = 40'000'000;
  std::size_t vertices = 120'000'000,
              corners = 120'000'000;     ///< corners: total number over all faces
  std::size_t face_corners = 1'000'000;  ///< corners of a single face
  std::size_t materials = 1'000'000;
};

/// Unchecked polygons of a file. Only vertex indices are guaranteed to be in range.
struct PolygonSoup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::uint32_t> corners;         ///< vertex indices of all polygons
  std::vector<std::size_t> polygon_begin{0};  ///< polygon i is corners [begin[i], begin[i + 1])
  std::vector<std::string> materials;  ///< names; empty unless the file is an OBJ with materials
  std::vector<std::uint32_t> polygon_materials;  ///< one index per polygon, if there are materials
};

PolygonSoup parse_ply(std::string_view name, std::string_view bytes, const MeshLimits& limits = {});
PolygonSoup parse_obj(std::string_view name, std::string_view text, const MeshLimits& limits = {});
PolygonSoup parse_off(std::string_view name, std::string_view text, const MeshLimits& limits = {});
/// Parses an ASCII or binary STL file.
PolygonSoup parse_stl(std::string_view name, std::string_view bytes, const MeshLimits& limits = {});

/// Removes polygons with a non-finite corner and returns their number.
std::size_t drop_infinite_polygons(PolygonSoup& soup);

/// Triangulates the polygons in their best-fitting planes and keeps their orientation. Polygons
/// with fewer than three corners are skipped. Throws Error{bad_file} if a corner is not finite, or
/// if a non-convex polygon has more than 1000 corners.
Mesh triangulate(std::string_view name, PolygonSoup soup);

/// Throws Error{bad_file} with a one-line message that begins with `name`.
[[noreturn]] inline void fail_mesh(std::string_view name, const std::string& what) {
  throw Error(ErrorKind::bad_file, std::string(name) + ": " + what);
}

inline std::string no_such_vertex(std::int64_t vertex, std::size_t count) {
  return "has vertex " + std::to_string(vertex) + ", but there are " + std::to_string(count) +
         " vertices, counted from 0";
}

/// Polygon soup with enforced size limits.
class BoundedSoup {
 public:
  BoundedSoup(std::string_view name, const MeshLimits& limits) : name_(name), limits_(limits) {}

  const PolygonSoup& soup() const { return soup_; }
  PolygonSoup& soup() { return soup_; }

  /// Checks declared sizes before memory is allocated. Throws Error{bad_file} if they exceed the
  /// limits.
  void require(std::uint64_t vertices, std::uint64_t faces) const {
    if (vertices > limits_.vertices || faces > limits_.faces) fail_too_large();
  }

  void add_vertex(const Eigen::Vector3d& vertex) {
    if (soup_.vertices.size() == limits_.vertices) fail_too_large();
    soup_.vertices.push_back(vertex);
  }

  /// Adds a corner to the current polygon, which close_polygon() completes.
  void add_corner(std::uint32_t vertex) {
    if (soup_.corners.size() == limits_.corners) fail_too_large();
    if (soup_.corners.size() - soup_.polygon_begin.back() == limits_.face_corners) {
      fail_mesh(name_, "face " + std::to_string(soup_.polygon_begin.size() - 1) +
                           " has more than " + std::to_string(limits_.face_corners) +
                           " corners; triangulate it first");
    }
    soup_.corners.push_back(vertex);
  }

  void close_polygon() {
    if (soup_.polygon_begin.size() > limits_.faces) fail_too_large();
    soup_.polygon_begin.push_back(soup_.corners.size());
  }

 private:
  [[noreturn]] void fail_too_large() const {
    fail_mesh(name_, "contains more than " + std::to_string(limits_.faces) + " faces, " +
                         std::to_string(limits_.corners) + " corners of faces or " +
                         std::to_string(limits_.vertices) + " vertices; simplify the mesh");
  }

  std::string_view name_;
  MeshLimits limits_;
  PolygonSoup soup_;
};

}  // namespace skycap::geometry
