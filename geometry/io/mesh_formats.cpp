#include "geometry/io/mesh_formats.h"

#include <array>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <unordered_map>

#include "geometry/error.h"
#include "geometry/io/ply.h"
#include "geometry/io/text_scanner.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

[[noreturn]] void fail(std::string_view name, const std::string& what) {
  throw Error(ErrorKind::bad_file, std::string(name) + ": " + what);
}

std::string no_such_vertex(std::int64_t vertex, std::size_t count) {
  return "names vertex " + std::to_string(vertex) + ", but there are " + std::to_string(count) +
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

  void add_vertex(const Vector3d& vertex) {
    if (soup_.vertices.size() == limits_.vertices) fail_of_size();
    soup_.vertices.push_back(vertex);
  }

  /// Of the polygon that is closed next.
  void add_corner(std::uint32_t vertex) {
    if (soup_.corners.size() == limits_.corners) fail_of_size();
    if (soup_.corners.size() - soup_.polygon_begin.back() == limits_.face_corners) {
      fail(name_, "face " + std::to_string(soup_.polygon_begin.size() - 1) + " has more than " +
                      std::to_string(limits_.face_corners) + " corners; triangulate it first");
    }
    soup_.corners.push_back(vertex);
  }

  void close_polygon() {
    if (soup_.polygon_begin.size() > limits_.faces) fail_of_size();
    soup_.polygon_begin.push_back(soup_.corners.size());
  }

 private:
  [[noreturn]] void fail_of_size() const {
    fail(name_, "holds more than " + std::to_string(limits_.faces) + " faces, " +
                    std::to_string(limits_.corners) + " corners of faces or " +
                    std::to_string(limits_.vertices) + " vertices; simplify the mesh");
  }

  std::string_view name_;
  MeshLimits limits_;
  PolygonSoup soup_;
};

constexpr std::uint64_t ply_piece = 1'000'000;  // rows whose numbers are held at once

void read_ply_vertices(std::string_view name, PlyReader& reader, std::uint64_t count,
                       BoundedSoup& soup) {
  constexpr std::array<std::string_view, 3> coordinates{"x", "y", "z"};
  for (std::uint64_t read = 0; read < count;) {
    const PlyTable table = reader.read_rows(coordinates, {}, ply_piece);
    const auto& [x, y, z] = std::tie(table.columns[0], table.columns[1], table.columns[2]);
    if (x.size() != table.rows || y.size() != table.rows || z.size() != table.rows) {
      fail(name, "the element 'vertex' must have the properties x, y and z");
    }
    if (read == 0) soup.soup().vertices.reserve(count);
    for (std::size_t i = 0; i < x.size(); ++i) soup.add_vertex({x[i], y[i], z[i]});
    read += table.rows;
  }
}

void read_ply_faces(std::string_view name, PlyReader& reader, std::uint64_t count,
                    std::uint64_t vertex_count, BoundedSoup& soup) {
  constexpr std::array<std::string_view, 2> corner_lists{"vertex_indices", "vertex_index"};
  for (std::uint64_t read = 0; read < count;) {
    const PlyTable table = reader.read_rows({}, corner_lists, ply_piece);
    for (std::size_t row = 0; row + 1 < table.list_begin.size(); ++row) {
      for (std::uint64_t i = table.list_begin[row]; i < table.list_begin[row + 1]; ++i) {
        const std::int64_t vertex = table.list_values[i];
        if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertex_count) {
          fail(name,
               "face " + std::to_string(read + row) + " " + no_such_vertex(vertex, vertex_count));
        }
        soup.add_corner(static_cast<std::uint32_t>(vertex));
      }
      soup.close_polygon();
    }
    read += table.rows;
  }
}

}  // namespace

PolygonSoup parse_ply(std::string_view name, std::string_view bytes, const MeshLimits& limits) {
  PlyReader reader(name, bytes);
  BoundedSoup soup(name, limits);
  const auto vertex_element =
      std::find_if(reader.elements().begin(), reader.elements().end(),
                   [](const PlyElement& element) { return element.name == "vertex"; });
  if (vertex_element == reader.elements().end()) {
    fail(name, "there is no element 'vertex'; a mesh must have one");
  }
  const std::uint64_t vertex_count = vertex_element->count;
  for (const PlyElement& element : reader.elements()) {
    const bool is_face = element.name == "face";
    soup.require(vertex_count, is_face ? element.count : 0);
    if (&element == &*vertex_element) {
      read_ply_vertices(name, reader, element.count, soup);
    } else if (is_face) {
      read_ply_faces(name, reader, element.count, vertex_count, soup);
    } else {
      reader.read_element({});
    }
  }
  return std::move(soup.soup());
}

namespace {

class ObjReader {
 public:
  ObjReader(std::string_view name, std::string_view text, const MeshLimits& limits)
      : scanner_(name, text), most_materials_(limits.materials), polygons_(name, limits) {}

  PolygonSoup read() {
    do {
      const auto keyword = scanner_.word_in_line();
      if (keyword == "v") read_vertex();
      if (keyword == "usemtl") read_material();
      if (keyword == "f") read_face();
    } while (scanner_.next_line());
    check_corners();
    return std::move(soup_);
  }

 private:
  void read_vertex() {
    Vector3d vertex;
    for (double& coordinate : vertex) {
      coordinate = scanner_.number<double>(scanner_.word_in_line(), "a coordinate");
    }
    polygons_.add_vertex(vertex);
  }

  void read_material() {
    // Faces before the first one have the material without a name.
    if (soup_.materials.empty() && !lines_.empty()) use_material("");
    soup_.polygon_materials.resize(lines_.size(), 0);
    use_material(std::string(scanner_.word_in_line().value_or("")));
  }

  void use_material(const std::string& wanted) {
    const auto number = static_cast<std::uint32_t>(soup_.materials.size());
    const auto [known, is_new] = materials_.emplace(wanted, number);
    if (is_new && number == most_materials_) {
      scanner_.fail("names more than " + std::to_string(most_materials_) + " materials");
    }
    material_ = known->second;
    if (is_new) soup_.materials.push_back(wanted);
  }

  void read_face() {
    if (!soup_.materials.empty()) soup_.polygon_materials.push_back(material_);
    lines_.push_back(static_cast<std::uint32_t>(scanner_.line()));
    while (const auto corner = scanner_.word_in_line()) {
      if (corner == "\\") {  // goes on in the next line
        scanner_.next_line();
      } else {
        polygons_.add_corner(vertex_of(*corner));
      }
    }
    polygons_.close_polygon();
  }

  std::uint32_t vertex_of(std::string_view corner) {
    const auto position = corner.substr(0, corner.find('/'));
    const auto index = scanner_.number<std::int64_t>(position, "a vertex index");
    // Counted from 1, or backwards from the latest vertex.
    const auto count = static_cast<std::int64_t>(soup_.vertices.size());
    const std::int64_t vertex = index > 0 ? index - 1 : index + count;
    if (index == 0 || vertex < 0 || vertex > std::numeric_limits<std::uint32_t>::max()) {
      scanner_.fail("the face names vertex " + std::to_string(index) + ", but the " +
                    std::to_string(count) + " vertices so far are counted from 1, or from -1 " +
                    "backwards");
    }
    return static_cast<std::uint32_t>(vertex);
  }

  /// Faces may come before their vertices.
  void check_corners() const {
    for (std::size_t polygon = 0; polygon < lines_.size(); ++polygon) {
      for (std::size_t i = soup_.polygon_begin[polygon]; i < soup_.polygon_begin[polygon + 1];
           ++i) {
        if (soup_.corners[i] < soup_.vertices.size()) continue;
        scanner_.fail_at(lines_[polygon], "the face names vertex " +
                                              std::to_string(soup_.corners[i] + std::uint64_t{1}) +
                                              ", but there are only " +
                                              std::to_string(soup_.vertices.size()));
      }
    }
  }

  TextScanner scanner_;
  std::size_t most_materials_;
  BoundedSoup polygons_;
  PolygonSoup& soup_ = polygons_.soup();
  std::vector<std::uint32_t> lines_;  // of each polygon, for the check of its corners
  std::uint32_t material_ = 0;
  std::unordered_map<std::string, std::uint32_t> materials_;  // numbers by names
};

}  // namespace

PolygonSoup parse_obj(std::string_view name, std::string_view text, const MeshLimits& limits) {
  return ObjReader(name, text, limits).read();
}

namespace {

// The first word of the next line that is neither empty nor a comment.
std::optional<std::string_view> off_line(TextScanner& scanner) {
  while (scanner.next_line()) {
    const auto word = scanner.word_in_line();
    if (word && !word->starts_with('#')) return word;
  }
  return std::nullopt;
}

}  // namespace

PolygonSoup parse_off(std::string_view name, std::string_view text, const MeshLimits& limits) {
  TextScanner scanner(name, text);
  auto word = scanner.word_in_line();
  while ((!word || word->starts_with('#')) && scanner.next_line()) word = scanner.word_in_line();
  if (!word || !word->ends_with("OFF") || word->starts_with('4') || word->starts_with("n")) {
    scanner.fail("an OFF file of points in space begins with 'OFF', 'COFF', 'NOFF' or 'STOFF'");
  }
  auto count = scanner.word_in_line();  // the counts may follow on the same line
  if (!count || count->starts_with('#')) count = off_line(scanner);
  if (count == "BINARY") scanner.fail("binary OFF is not read; save it as ascii OFF or as PLY");
  const auto vertex_count = scanner.number<std::uint64_t>(count, "the number of vertices");
  const auto face_count =
      scanner.number<std::uint64_t>(scanner.word_in_line(), "the number of faces");
  // A line of a vertex takes 6 characters or more, one of a face 2.
  if (vertex_count > scanner.remaining() / 6 + 1 || face_count > scanner.remaining() / 2 + 1) {
    scanner.fail(std::to_string(vertex_count) + " vertices and " + std::to_string(face_count) +
                 " faces are promised, but the file is too short for so many");
  }
  BoundedSoup soup(name, limits);
  soup.require(vertex_count, face_count);
  soup.soup().vertices.reserve(vertex_count);
  for (std::uint64_t v = 0; v < vertex_count; ++v) {
    Vector3d vertex;
    vertex.x() = scanner.number<double>(off_line(scanner), "a coordinate");
    vertex.y() = scanner.number<double>(scanner.word_in_line(), "a coordinate");
    vertex.z() = scanner.number<double>(scanner.word_in_line(), "a coordinate");
    soup.add_vertex(vertex);
  }
  for (std::uint64_t face = 0; face < face_count; ++face) {
    const auto corners =
        scanner.number<std::uint32_t>(off_line(scanner), "the number of a face's corners");
    for (std::uint32_t i = 0; i < corners; ++i) {
      const auto vertex = scanner.number<std::int64_t>(scanner.word_in_line(), "a vertex index");
      if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertex_count) {
        scanner.fail("the face " + no_such_vertex(vertex, vertex_count));
      }
      soup.add_corner(static_cast<std::uint32_t>(vertex));
    }
    soup.close_polygon();
  }
  return std::move(soup.soup());
}

namespace {

constexpr std::size_t stl_header = 84;    // 80 bytes of anything, and the count
constexpr std::size_t stl_triangle = 50;  // normal, three corners, two bytes of anything

std::uint32_t stl_count(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  return count;
}

void add_own_vertex(BoundedSoup& soup, const Vector3d& vertex) {
  soup.add_corner(static_cast<std::uint32_t>(soup.soup().vertices.size()));
  soup.add_vertex(vertex);
}

PolygonSoup parse_binary_stl(std::string_view name, std::string_view bytes,
                             const MeshLimits& limits) {
  BoundedSoup soup(name, limits);
  const std::uint32_t count = stl_count(bytes);
  soup.require(0, count);
  soup.soup().vertices.reserve(std::size_t{3} * count);
  for (std::size_t triangle = 0; triangle < count; ++triangle) {
    std::array<float, 12> numbers;  // normal and corners
    std::memcpy(numbers.data(), bytes.data() + stl_header + triangle * stl_triangle,
                sizeof(numbers));
    for (std::size_t i = 3; i < 12; i += 3) {
      add_own_vertex(soup,
                     Eigen::Vector3f(numbers[i], numbers[i + 1], numbers[i + 2]).cast<double>());
    }
    soup.close_polygon();
  }
  return std::move(soup.soup());
}

PolygonSoup parse_ascii_stl(std::string_view name, std::string_view text,
                            const MeshLimits& limits) {
  TextScanner scanner(name, text);
  scanner.next_line();  // 'solid' and a name
  BoundedSoup soup(name, limits);
  while (const auto word = scanner.word()) {
    if (word == "vertex") {
      Vector3d vertex;
      for (double& coordinate : vertex) {
        coordinate = scanner.number<double>(scanner.word_in_line(), "a coordinate");
      }
      add_own_vertex(soup, vertex);
    } else if (word == "endloop") {
      soup.close_polygon();
    } else if (word == "facet" || word == "solid" || word == "endsolid") {
      scanner.next_line();  // the normal or the name
    } else if (word != "outer" && word != "loop" && word != "endfacet") {
      scanner.fail("'" + std::string(word->substr(0, 40)) + "' is no word of an STL file");
    }
  }
  if (soup.soup().corners.size() != soup.soup().polygon_begin.back()) {
    scanner.fail("ends within a facet; it may have been cut off");
  }
  return std::move(soup.soup());
}

}  // namespace

PolygonSoup parse_stl(std::string_view name, std::string_view bytes, const MeshLimits& limits) {
  // Some binary files begin with 'solid' too, so the length has the first say.
  const bool has_count = bytes.size() >= stl_header;
  const std::uint64_t count = has_count ? stl_count(bytes) : 0;
  const std::uint64_t wanted = stl_header + count * stl_triangle;
  if (has_count && wanted == bytes.size()) return parse_binary_stl(name, bytes, limits);
  if (bytes.starts_with("solid")) return parse_ascii_stl(name, bytes, limits);
  if (!has_count) fail(name, "is neither ascii STL, which begins with 'solid', nor binary STL");
  if (wanted > bytes.size()) {
    fail(name, "promises " + std::to_string(count) + " triangles in binary STL, but is " +
                   std::to_string(bytes.size()) + " bytes long instead of " +
                   std::to_string(wanted) + "; it may have been cut off");
  }
  return parse_binary_stl(name, bytes, limits);
}

}  // namespace skycap::geometry
