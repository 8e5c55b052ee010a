// Meshes in PLY files: faces, or triangle strips as written by older scanners.
#include "geometry/io/mesh_formats.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <tuple>

#include "geometry/io/text/ply.h"

namespace skycap::geometry {
namespace {

constexpr std::uint64_t ply_chunk_rows = 1'000'000;  // maximum rows in memory at a time

void read_ply_vertices(std::string_view name, PlyReader& reader, std::uint64_t count,
                       BoundedSoup& soup) {
  constexpr std::array<std::string_view, 3> coordinates{"x", "y", "z"};
  for (std::uint64_t read = 0; read < count;) {
    const PlyTable table = reader.read_rows(coordinates, {}, ply_chunk_rows);
    const auto& [x, y, z] = std::tie(table.columns[0], table.columns[1], table.columns[2]);
    if (x.size() != table.rows || y.size() != table.rows || z.size() != table.rows) {
      fail_mesh(name, "the element 'vertex' must have the properties x, y and z");
    }
    if (read == 0) soup.soup().vertices.reserve(count);
    for (std::size_t i = 0; i < x.size(); ++i) soup.add_vertex({x[i], y[i], z[i]});
    read += table.rows;
  }
}

/// Returns the name of the corner list of an element: a common name, otherwise its only list.
std::string find_corner_list(std::string_view name, const PlyElement& element) {
  constexpr std::array<std::string_view, 4> usual{"vertex_indices", "vertex_index",
                                                  "vertex_indexes", "vertices"};
  std::vector<std::string> lists;
  for (const PlyProperty& property : element.properties) {
    if (property.count_type) lists.push_back(property.name);
  }
  for (const std::string_view candidate : usual) {
    if (std::ranges::find(lists, candidate) != lists.end()) return std::string(candidate);
  }
  if (lists.size() == 1) return lists[0];
  if (lists.empty() || element.count == 0) return {};
  std::string all;
  for (const std::string& list : lists) all += (all.empty() ? "" : ", ") + list;
  fail_mesh(name, "the element '" + element.name + "' has the lists " + all +
                      "; the list of corners must be named vertex_indices");
}

/// Converts strips to triangles with uniform orientation; -1 begins a new strip.
class StripReader {
 public:
  explicit StripReader(BoundedSoup& soup) : soup_(soup) {}

  void restart() { strip_ = {}; }
  void add(std::uint32_t vertex) {
    if (strip_.size >= 2) {
      const bool is_odd = strip_.size % 2 == 1;
      soup_.add_corner(strip_.last[is_odd ? 1 : 0]);
      soup_.add_corner(strip_.last[is_odd ? 0 : 1]);
      soup_.add_corner(vertex);
      soup_.close_polygon();
    }
    strip_.last = {strip_.last[1], vertex};
    ++strip_.size;
  }

 private:
  struct Strip {
    std::size_t size = 0;
    std::array<std::uint32_t, 2> last{};
  };
  BoundedSoup& soup_;
  Strip strip_;
};

/// Reads the element 'face' or 'tristrips'.
void read_ply_faces(std::string_view name, PlyReader& reader, const PlyElement& element,
                    std::uint64_t vertex_count, BoundedSoup& soup) {
  const bool is_strip = element.name == "tristrips";
  const std::string list = find_corner_list(name, element);
  const std::array<std::string_view, 1> lists{list};
  for (std::uint64_t read = 0; read < element.count;) {
    const PlyTable table = reader.read_rows({}, lists, ply_chunk_rows);
    for (std::size_t row = 0; row + 1 < table.list_begin.size(); ++row) {
      StripReader strip(soup);
      for (std::uint64_t i = table.list_begin[row]; i < table.list_begin[row + 1]; ++i) {
        const std::int64_t vertex = table.list_values[i];
        constexpr std::int64_t unsigned_restart = std::numeric_limits<std::uint32_t>::max();
        if (is_strip && (vertex == -1 || vertex == unsigned_restart)) {
          strip.restart();
          continue;
        }
        if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertex_count) {
          fail_mesh(name, (is_strip ? "strip " : "face ") + std::to_string(read + row) + " " +
                              no_such_vertex(vertex, vertex_count));
        }
        if (is_strip) {
          strip.add(static_cast<std::uint32_t>(vertex));
        } else {
          soup.add_corner(static_cast<std::uint32_t>(vertex));
        }
      }
      if (!is_strip) soup.close_polygon();
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
    fail_mesh(name, "missing element 'vertex'");
  }
  const std::uint64_t vertex_count = vertex_element->count;
  for (const PlyElement& element : reader.elements()) {
    const bool is_face = element.name == "face" || element.name == "tristrips";
    soup.require(vertex_count, is_face ? element.count : 0);
    if (&element == &*vertex_element) {
      read_ply_vertices(name, reader, element.count, soup);
    } else if (is_face) {
      read_ply_faces(name, reader, element, vertex_count, soup);
    } else {
      reader.read_element({});
    }
  }
  return std::move(soup.soup());
}

}  // namespace skycap::geometry
