/// Reads and writes triangle meshes: PLY (ASCII and both binary byte orders), OBJ, STL (ASCII and
/// binary), OFF, and Draco (reading only). All formats may be gzip-compressed.
///
/// Text may begin with a UTF-8 byte-order mark, and lines may end with \n, \r\n or \r.
///
/// Only positions and polygons are read, and material names of OBJ files on request. Normals,
/// colours and textures are ignored. Polygons are triangulated and vertices with equal coordinates
/// are merged. Unused vertices and triangles without area are removed. The orientation of the
/// triangles is that of the file, which is often wrong; `orient_outward` corrects it. Axes and
/// units are those of the file.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

struct MeshOptions {
  bool orient_outward = false;  ///< orient triangles with orient_outward() of mesh_repair.h
  /// Receives a message about skipped polygons, which have a NaN or infinite corner. Without it,
  /// such polygons are an error.
  std::function<void(const std::string&)> note = {};
};

/// Reads a mesh. The format follows from the ending of the file name: .ply, .obj, .stl, .off or
/// .drc, optionally followed by .gz. Throws Error{bad_file} with a one-line message that names the
/// file, the line or face, and the rule. A mesh without a triangle of positive area is also an
/// error.
Mesh read_mesh(const std::filesystem::path& path, const MeshOptions& options = {});

/// Returns whether the file name has an ending that read_mesh() supports.
bool is_mesh_file(const std::filesystem::path& path);

/// Part of a mesh with a single material.
struct MaterialMesh {
  std::string material;  ///< name after usemtl; may be empty
  Mesh mesh;
};

/// Reads a mesh with read_mesh() and splits it by material. A file without materials has one part
/// without a name.
std::vector<MaterialMesh> read_mesh_by_material(const std::filesystem::path& path);

/// Writes .ply (binary little-endian; float if that is exact, otherwise double), .obj, .stl
/// (binary, single precision) or .off, according to the ending of the file name. The write is
/// atomic. Throws Error{bad_file}.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

/// Decodes a mesh in Draco format. Nothing is merged or removed. Every message begins with `name`.
/// Throws Error{bad_file}.
Mesh decode_draco(std::string_view name, std::string_view bytes);

}  // namespace skycap::geometry
