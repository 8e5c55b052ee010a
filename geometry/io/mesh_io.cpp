#include "geometry/io/mesh_io.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/byte_values.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/mesh_formats.h"
#include "geometry/io/text/plain_text.h"
#include "geometry/io/text/ply.h"
#include "geometry/surfaces/mesh_repair.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

// Limits for files that decompress to a much larger size, so that less than 2 GiB are used,
// including intermediate results. Uncompressed files are not limited, because their size is known
// to the user.
constexpr std::size_t largest_unpacked_mesh = std::size_t{256} << 20, max_unpacked = 10'000'000;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::bad_file, path.string() + ": " + what);
}

PolygonSoup parse(const fs::path& path) {
  const std::string format = lower_extension(path);
  if (format == ".drc") {
    const std::string bytes = read_file(path, largest_whole_file, largest_unpacked_mesh);
    const Mesh mesh = decode_draco(path.string(), bytes);
    if (mesh.triangles.size() > max_unpacked) fail(path, "contains more than 10 million triangles");
    PolygonSoup soup{mesh.vertices, {}};  // checked like the polygons of other formats
    for (const auto& triangle : mesh.triangles) {
      soup.corners.insert(soup.corners.end(), triangle.begin(), triangle.end());
      soup.polygon_begin.push_back(soup.corners.size());
    }
    return soup;
  }
  const auto parser = format == ".ply"   ? parse_ply
                      : format == ".obj" ? parse_obj
                      : format == ".stl" ? parse_stl
                      : format == ".off" ? parse_off
                                         : nullptr;
  if (parser == nullptr) {
    fail(path,
         "the name of a mesh file must end in .ply, .obj, .stl, .off or .drc, optionally followed "
         "by .gz");
  }
  const bool is_always_text = format == ".obj" || format == ".off";
  std::string bytes = read_file(path, largest_whole_file, largest_unpacked_mesh);
  if (is_always_text) bytes = as_utf8(std::move(bytes));
  if (bytes.empty()) fail(path, "is empty");
  return parser(path.string(), bytes, {});
}

/// Splits the polygons by material, each part with its own vertices. Returns one part if there are
/// no materials. The time is proportional to the file size, independent of the number of materials.
std::vector<PolygonSoup> parts_by_material(PolygonSoup soup) {
  if (soup.materials.empty()) {
    std::vector<PolygonSoup> whole;
    whole.push_back(std::move(soup));
    return whole;
  }
  const std::size_t count = soup.polygon_begin.size() - 1;
  std::vector<std::vector<std::size_t>> polygons(soup.materials.size());
  for (std::size_t i = 0; i < count; ++i) polygons[soup.polygon_materials[i]].push_back(i);

  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> index_in_part(soup.vertices.size(), none);
  std::vector<PolygonSoup> parts(soup.materials.size());
  for (std::size_t material = 0; material < parts.size(); ++material) {
    PolygonSoup& part = parts[material];
    std::vector<std::uint32_t> used;
    for (const std::size_t i : polygons[material]) {
      for (std::size_t c = soup.polygon_begin[i]; c < soup.polygon_begin[i + 1]; ++c) {
        const std::uint32_t vertex = soup.corners[c];
        if (index_in_part[vertex] == none) {
          index_in_part[vertex] = static_cast<std::uint32_t>(part.vertices.size());
          part.vertices.push_back(soup.vertices[vertex]);
          used.push_back(vertex);
        }
        part.corners.push_back(index_in_part[vertex]);
      }
      part.polygon_begin.push_back(part.corners.size());
    }
    for (const std::uint32_t vertex : used) index_in_part[vertex] = none;
  }
  return parts;
}

Mesh clean_mesh(const fs::path& path, PolygonSoup soup) {
  Mesh mesh = triangulate(path.string(), std::move(soup));
  weld_vertices(mesh);
  drop_degenerate_triangles(mesh);
  return mesh;
}

void require_faces(const fs::path& path, const PolygonSoup& soup) {
  const auto is_polygon = [&](std::size_t i) {
    return soup.polygon_begin[i + 1] - soup.polygon_begin[i] >= 3;
  };
  for (std::size_t i = 0; i + 1 < soup.polygon_begin.size(); ++i) {
    if (is_polygon(i)) return;
  }
  fail(path, soup.vertices.empty() ? "contains neither vertices nor faces; expected a mesh"
                                   : "contains no faces; expected a mesh, not a point cloud");
}

template <typename Number>
void append_text(std::string& text, Number number) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  text += ' ';
  text.append(digits.data(), end);
}

bool is_single_precision(const Mesh& mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vector3d& vertex) {
    return vertex.cast<float>().cast<double>() == vertex;
  });
}

std::string format_ply(const Mesh& mesh) {
  const bool is_single = is_single_precision(mesh);
  std::array<PlyElement, 2> elements{
      {{"vertex", mesh.vertices.size(), {}},
       {"face", mesh.triangles.size(), {{"vertex_indices", PlyType::int32, PlyType::uint8}}}}};
  elements[0].add(is_single ? PlyType::float32 : PlyType::float64, {"x", "y", "z"});
  std::string bytes = ply_header(elements);
  for (const Vector3d& vertex : mesh.vertices) {
    if (is_single) {
      append_value(bytes, Eigen::Vector3f(vertex.cast<float>()));
    } else {
      append_value(bytes, vertex);
    }
  }
  for (const auto& triangle : mesh.triangles) {
    append_value(bytes, std::uint8_t{3});
    append_value(bytes, triangle);
  }
  return bytes;
}

std::string format_obj(const Mesh& mesh) {
  std::string text = "# written by Skycap\n";
  for (const Vector3d& vertex : mesh.vertices) {
    text += 'v';
    for (const double coordinate : vertex) append_text(text, coordinate);
    text += '\n';
  }
  for (const auto& triangle : mesh.triangles) {
    text += 'f';
    for (const std::uint32_t v : triangle) append_text(text, v + std::uint64_t{1});
    text += '\n';
  }
  return text;
}

std::string format_off(const Mesh& mesh) {
  std::string text = "OFF\n" + std::to_string(mesh.vertices.size()) + " " +
                     std::to_string(mesh.triangles.size()) + " 0\n";
  for (const Vector3d& vertex : mesh.vertices) {
    for (const double coordinate : vertex) append_text(text, coordinate);
    text += '\n';
  }
  for (const auto& triangle : mesh.triangles) {
    text += '3';
    for (const std::uint32_t v : triangle) append_text(text, v);
    text += '\n';
  }
  return text;
}

std::string format_stl(const Mesh& mesh) {
  std::string bytes = "written by Skycap";
  bytes.resize(80, ' ');
  append_value(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    const Vector3d &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]],
                   &c = mesh.vertices[triangle[2]];
    append_value(bytes, Eigen::Vector3f((b - a).cross(c - a).normalized().cast<float>()));
    for (const Vector3d* corner : {&a, &b, &c}) {
      append_value(bytes, Eigen::Vector3f(corner->cast<float>()));
    }
    append_value(bytes, std::uint16_t{0});
  }
  return bytes;
}

}  // namespace

bool is_mesh_file(const fs::path& path) {
  constexpr std::array<std::string_view, 5> formats = {".ply", ".obj", ".stl", ".off", ".drc"};
  return std::ranges::find(formats, lower_extension(path)) != formats.end();
}

Mesh read_mesh(const fs::path& path, const MeshOptions& options) {
  PolygonSoup soup = parse(path);
  require_faces(path, soup);
  const std::size_t skipped = options.note ? drop_infinite_polygons(soup) : 0;
  if (skipped > 0) {
    options.note(std::to_string(skipped) +
                 " faces skipped (a corner is NaN or infinite); their area is unknown");
  }
  Mesh mesh = clean_mesh(path, std::move(soup));
  if (mesh.triangles.empty()) fail(path, "contains no triangle with a positive area");
  if (options.orient_outward) orient_outward(mesh);
  return mesh;
}

std::vector<MaterialMesh> read_mesh_by_material(const fs::path& path) {
  PolygonSoup soup = parse(path);
  require_faces(path, soup);
  std::vector<MaterialMesh> parts;
  const std::vector<std::string> materials = soup.materials;
  std::vector<PolygonSoup> polygons = parts_by_material(std::move(soup));
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    Mesh mesh = clean_mesh(path, std::move(polygons[i]));
    if (mesh.triangles.empty()) continue;
    parts.push_back({materials.empty() ? "" : materials[i], std::move(mesh)});
  }
  if (parts.empty()) fail(path, "contains no triangle with a positive area");
  return parts;
}

void write_mesh(const fs::path& path, const Mesh& mesh) {
  const std::string format = path.extension().string();
  if (format == ".ply") return write_file(path, format_ply(mesh));
  if (format == ".obj") return write_file(path, format_obj(mesh));
  if (format == ".off") return write_file(path, format_off(mesh));
  if (format == ".stl") return write_file(path, format_stl(mesh));
  fail(path, "the name of an output mesh file must end in .ply, .obj, .stl or .off");
}

}  // namespace skycap::geometry
