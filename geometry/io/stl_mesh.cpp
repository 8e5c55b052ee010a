// ASCII and binary STL, including common deviations of writers.
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "geometry/io/mesh_formats.h"
#include "geometry/io/text/text_scanner.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

constexpr std::size_t stl_header = 84;    // 80 arbitrary bytes and the count
constexpr std::size_t stl_triangle = 50;  // normal, three corners, two arbitrary bytes

std::uint32_t stl_count(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  return count;
}

void add_own_vertex(BoundedSoup& soup, const Vector3d& vertex) {
  soup.add_corner(static_cast<std::uint32_t>(soup.soup().vertices.size()));
  soup.add_vertex(vertex);
}

PolygonSoup parse_binary_stl(std::string_view name, std::string_view bytes, std::uint64_t count,
                             const MeshLimits& limits) {
  BoundedSoup soup(name, limits);
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

/// Parser of ASCII STL. Keywords may be in upper or lower case, and end keywords may be one or two
/// words.
class AsciiStl {
 public:
  AsciiStl(std::string_view name, std::string_view text, const MeshLimits& limits)
      : scanner_(name, text), soup_(name, limits) {}

  PolygonSoup read() {
    while (const auto word = scanner_.word()) read_statement(lower_case(*word), *word);
    if (soup_.soup().corners.size() != soup_.soup().polygon_begin.back()) {
      scanner_.fail("ends within a facet; it may be truncated");
    }
    return std::move(soup_.soup());
  }

 private:
  void read_statement(std::string word, std::string_view as_written) {
    if (word == "end") word += lower_case(scanner_.word_in_line().value_or(""));
    if (word == "vertex") {
      Vector3d vertex;
      for (double& coordinate : vertex) {
        coordinate = scanner_.number<double>(scanner_.word_in_line(), "a coordinate");
      }
      add_own_vertex(soup_, vertex);
    } else if (word == "endloop") {
      soup_.close_polygon();
    } else if (word == "facet" || word == "solid" || word == "endsolid" || word == "color") {
      scanner_.next_line();  // normal, name or colour
    } else if (word != "outer" && word != "loop" && word != "endfacet") {
      scanner_.fail("'" + std::string(as_written.substr(0, 40)) + "' is not an STL keyword");
    }
  }

  TextScanner scanner_;
  BoundedSoup soup_;
};

/// Returns whether the file is ASCII STL. Binary files may begin with 'solid', too. ASCII files
/// contain no zero bytes, and facets follow.
bool is_ascii_stl(std::string_view bytes) {
  const std::string_view text = without_mark(bytes);
  const std::string beginning = lower_case(trimmed(text.substr(0, 1 << 12)));
  if (!beginning.starts_with("solid")) return false;
  if (beginning.find('\0') != std::string::npos) return false;
  return text.size() < stl_header || beginning.find("facet") != std::string::npos ||
         beginning.find("endsolid") != std::string::npos ||
         beginning.find("end solid") != std::string::npos;
}

}  // namespace

PolygonSoup parse_stl(std::string_view name, std::string_view bytes, const MeshLimits& limits) {
  const bool has_count = bytes.size() >= stl_header;
  const std::uint64_t count = has_count ? stl_count(bytes) : 0;
  const std::uint64_t expected_size = stl_header + count * stl_triangle;
  if (has_count && expected_size == bytes.size())
    return parse_binary_stl(name, bytes, count, limits);
  if (is_ascii_stl(bytes)) return AsciiStl(name, bytes, limits).read();
  if (!has_count) {
    fail_mesh(name, "is neither ASCII STL, which begins with 'solid', nor binary STL");
  }
  // Writers without random access cannot set the count; such files contain as many triangles as
  // fit.
  const std::uint64_t capacity = (bytes.size() - stl_header) / stl_triangle;
  const bool is_unknown = count == 0 || count == std::numeric_limits<std::uint32_t>::max();
  if (is_unknown && capacity > 0) return parse_binary_stl(name, bytes, capacity, limits);
  if (expected_size > bytes.size()) {
    fail_mesh(name, "declares " + std::to_string(count) + " triangles in binary STL, but is " +
                        std::to_string(bytes.size()) + " bytes long instead of " +
                        std::to_string(expected_size) + "; it may be truncated");
  }
  return parse_binary_stl(name, bytes, count, limits);
}

}  // namespace skycap::geometry
