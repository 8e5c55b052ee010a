#include "geometry/io/mesh_formats.h"

#include <array>
#include <cstring>
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

[[noreturn]] void fail_of_size(std::string_view name) {
  fail(name, "holds more than 4e7 faces, or 1.2e8 corners of faces or vertices; simplify the mesh");
}

void add_vertex(std::string_view name, PolygonSoup& soup, const Vector3d& vertex) {
  if (soup.vertices.size() == most_mesh_vertices) fail_of_size(name);
  soup.vertices.push_back(vertex);
}

void add_corner(std::string_view name, PolygonSoup& soup, std::uint32_t vertex) {
  if (soup.corners.size() == 3 * most_mesh_faces) fail_of_size(name);
  soup.corners.push_back(vertex);
}

void close_polygon(std::string_view name, PolygonSoup& soup) {
  if (soup.polygon_begin.size() > most_mesh_faces) fail_of_size(name);
  soup.polygon_begin.push_back(soup.corners.size());
}

/// What a file promises, before memory is taken for it.
void require_bounded(std::string_view name, std::uint64_t vertices, std::uint64_t faces) {
  if (vertices > most_mesh_vertices || faces > most_mesh_faces) fail_of_size(name);
}

}  // namespace

PolygonSoup parse_ply(std::string_view name, std::string_view bytes) {
  PlyReader reader(name, bytes);
  constexpr std::array<std::string_view, 3> coordinates{"x", "y", "z"};
  constexpr std::array<std::string_view, 2> corner_lists{"vertex_indices", "vertex_index"};
  PolygonSoup soup;
  const auto vertex_element =
      std::find_if(reader.elements().begin(), reader.elements().end(),
                   [](const PlyElement& element) { return element.name == "vertex"; });
  if (vertex_element == reader.elements().end()) {
    fail(name, "there is no element 'vertex'; a mesh must have one");
  }
  const std::uint64_t vertex_count = vertex_element->count;
  for (const PlyElement& element : reader.elements()) {
    require_bounded(name, vertex_count, element.name == "face" ? element.count : 0);
    PlyTable table = reader.read_element(coordinates, corner_lists);
    if (&element == &*vertex_element) {
      const auto& [x, y, z] = std::tie(table.columns[0], table.columns[1], table.columns[2]);
      if (x.size() != element.count || y.size() != element.count || z.size() != element.count) {
        fail(name, "the element 'vertex' must have the properties x, y and z");
      }
      soup.vertices.reserve(element.count);
      for (std::size_t i = 0; i < x.size(); ++i) soup.vertices.emplace_back(x[i], y[i], z[i]);
    } else if (element.name == "face") {
      soup.corners.reserve(table.list_values.size());
      soup.polygon_begin.reserve(table.list_begin.size());
      for (std::size_t face = 0; face + 1 < table.list_begin.size(); ++face) {
        for (std::uint64_t i = table.list_begin[face]; i < table.list_begin[face + 1]; ++i) {
          const std::int64_t vertex = table.list_values[i];
          if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertex_count) {
            fail(name, "face " + std::to_string(face) + " " + no_such_vertex(vertex, vertex_count));
          }
          add_corner(name, soup, static_cast<std::uint32_t>(vertex));
        }
        close_polygon(name, soup);
      }
    }
  }
  return soup;
}

namespace {

class ObjReader {
 public:
  ObjReader(std::string_view name, std::string_view text) : name_(name), scanner_(name, text) {}

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
    add_vertex(name_, soup_, vertex);
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
    if (is_new && number == most_mesh_materials) {
      scanner_.fail("names more than 1e6 materials");
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
        add_corner(name_, soup_, vertex_of(*corner));
      }
    }
    close_polygon(name_, soup_);
  }

  std::uint32_t vertex_of(std::string_view corner) {
    const auto position = corner.substr(0, corner.find('/'));
    const auto index = scanner_.number<std::int64_t>(position, "a vertex index");
    // Counted from 1, or backwards from the latest vertex.
    const auto count = static_cast<std::int64_t>(soup_.vertices.size());
    const std::int64_t vertex = index > 0 ? index - 1 : index + count;
    if (index == 0 || vertex < 0 || vertex >= static_cast<std::int64_t>(most_mesh_vertices)) {
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

  std::string_view name_;
  TextScanner scanner_;
  PolygonSoup soup_;
  std::vector<std::uint32_t> lines_;  // of each polygon, for the check of its corners
  std::uint32_t material_ = 0;
  std::unordered_map<std::string, std::uint32_t> materials_;  // numbers by names
};

}  // namespace

PolygonSoup parse_obj(std::string_view name, std::string_view text) {
  return ObjReader(name, text).read();
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

PolygonSoup parse_off(std::string_view name, std::string_view text) {
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
  require_bounded(name, vertex_count, face_count);

  PolygonSoup soup;
  soup.vertices.reserve(vertex_count);
  for (std::uint64_t v = 0; v < vertex_count; ++v) {
    Vector3d vertex;
    vertex.x() = scanner.number<double>(off_line(scanner), "a coordinate");
    vertex.y() = scanner.number<double>(scanner.word_in_line(), "a coordinate");
    vertex.z() = scanner.number<double>(scanner.word_in_line(), "a coordinate");
    soup.vertices.push_back(vertex);
  }
  for (std::uint64_t face = 0; face < face_count; ++face) {
    const auto corners =
        scanner.number<std::uint32_t>(off_line(scanner), "the number of a face's corners");
    for (std::uint32_t i = 0; i < corners; ++i) {
      const auto vertex = scanner.number<std::int64_t>(scanner.word_in_line(), "a vertex index");
      if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertex_count) {
        scanner.fail("the face " + no_such_vertex(vertex, vertex_count));
      }
      add_corner(name, soup, static_cast<std::uint32_t>(vertex));
    }
    close_polygon(name, soup);
  }
  return soup;
}

namespace {

constexpr std::size_t stl_header = 84;    // 80 bytes of anything, and the count
constexpr std::size_t stl_triangle = 50;  // normal, three corners, two bytes of anything

std::uint32_t stl_count(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  return count;
}

void add_own_vertex(std::string_view name, PolygonSoup& soup, const Vector3d& vertex) {
  add_corner(name, soup, static_cast<std::uint32_t>(soup.vertices.size()));
  add_vertex(name, soup, vertex);
}

PolygonSoup parse_binary_stl(std::string_view name, std::string_view bytes) {
  PolygonSoup soup;
  const std::uint32_t count = stl_count(bytes);
  require_bounded(name, 0, count);
  soup.vertices.reserve(std::size_t{3} * count);
  for (std::size_t triangle = 0; triangle < count; ++triangle) {
    std::array<float, 12> numbers;  // normal and corners
    std::memcpy(numbers.data(), bytes.data() + stl_header + triangle * stl_triangle,
                sizeof(numbers));
    for (std::size_t i = 3; i < 12; i += 3) {
      add_own_vertex(name, soup,
                     Eigen::Vector3f(numbers[i], numbers[i + 1], numbers[i + 2]).cast<double>());
    }
    close_polygon(name, soup);
  }
  return soup;
}

PolygonSoup parse_ascii_stl(std::string_view name, std::string_view text) {
  TextScanner scanner(name, text);
  scanner.next_line();  // 'solid' and a name
  PolygonSoup soup;
  while (const auto word = scanner.word()) {
    if (word == "vertex") {
      Vector3d vertex;
      for (double& coordinate : vertex) {
        coordinate = scanner.number<double>(scanner.word_in_line(), "a coordinate");
      }
      add_own_vertex(name, soup, vertex);
    } else if (word == "endloop") {
      close_polygon(name, soup);
    } else if (word == "facet" || word == "solid" || word == "endsolid") {
      scanner.next_line();  // the normal or the name
    } else if (word != "outer" && word != "loop" && word != "endfacet") {
      scanner.fail("'" + std::string(word->substr(0, 40)) + "' is no word of an STL file");
    }
  }
  if (soup.corners.size() != soup.polygon_begin.back()) {
    scanner.fail("ends within a facet; it may have been cut off");
  }
  return soup;
}

}  // namespace

PolygonSoup parse_stl(std::string_view name, std::string_view bytes) {
  // Some binary files begin with 'solid' too, so the length has the first say.
  const bool has_count = bytes.size() >= stl_header;
  const std::uint64_t count = has_count ? stl_count(bytes) : 0;
  const std::uint64_t wanted = stl_header + count * stl_triangle;
  if (has_count && wanted == bytes.size()) return parse_binary_stl(name, bytes);
  if (bytes.starts_with("solid")) return parse_ascii_stl(name, bytes);
  if (!has_count) fail(name, "is neither ascii STL, which begins with 'solid', nor binary STL");
  if (wanted > bytes.size()) {
    fail(name, "promises " + std::to_string(count) + " triangles in binary STL, but is " +
                   std::to_string(bytes.size()) + " bytes long instead of " +
                   std::to_string(wanted) + "; it may have been cut off");
  }
  return parse_binary_stl(name, bytes);
}

}  // namespace skycap::geometry
