/// Triangle meshes from and to files: PLY (ascii and both binary byte orders), OBJ, STL (ascii and
/// binary), OFF, and Draco for reading. Any of them may be gzip-compressed.
///
/// Text may begin with a mark of UTF-8, and its lines may end with \n, \r\n or \r.
///
/// Only positions and polygons are read, and the names of an OBJ's materials if they are asked for;
/// normals, colours, textures are passed over.
/// Polygons are cut into triangles, vertices of equal coordinates are joined, vertices that no
/// polygon uses and triangles without area are dropped. Which side of a triangle is outside is the
/// file's statement; files are often wrong about it, hence `orient_outward`. Axes and units are the
/// file's as well.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

struct MeshOptions {
  bool orient_outward = false;  ///< turn triangles as orient_outward() of mesh_repair.h does
  /// Is told in a sentence of polygons that are skipped, since a corner is NaN or infinite. Without
  /// it a file that has such a polygon is refused.
  std::function<void(const std::string&)> note = {};
};

/// The format goes by the name's ending: .ply, .obj, .stl, .off or .drc, and .gz after any of them.
/// Throws Error{bad_file} in one line that names the file, the line or face, and what would be
/// right, also if the mesh holds no triangle with an area.
Mesh read_mesh(const std::filesystem::path& path, const MeshOptions& options = {});

/// Whether a name ends as those of files that read_mesh() reads.
bool is_mesh_file(const std::filesystem::path& path);

/// The part of a mesh that is made of one material.
struct MaterialMesh {
  std::string material;  ///< the name behind usemtl; empty: none
  Mesh mesh;
};

/// The same as read_mesh(), by material; a file without materials is one part without a name.
std::vector<MaterialMesh> read_mesh_by_material(const std::filesystem::path& path);

/// Writes .ply (binary little-endian; float if that is exact, else double), .obj, .stl (binary, in
/// single precision) or .off, by the name's ending; complete or not at all. Throws Error{bad_file}.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

/// A mesh from Draco's compressed bytes, as they are: nothing is joined or dropped. `name` opens
/// the messages. Throws Error{bad_file}.
Mesh decode_draco(std::string_view name, std::string_view bytes);

}  // namespace skycap::geometry
