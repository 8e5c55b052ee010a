// OFF of Geomview and ModelNet: free-form, or one line per vertex and face.
#include <algorithm>
#include <optional>
#include <string>

#include "geometry/io/mesh_formats.h"
#include "geometry/io/text/text_scanner.h"

namespace skycap::geometry {
namespace {

using std::string_view;

/// Header before the counts.
struct OffHeader {
  std::size_t extra_vertex_values =
      0;                   ///< numbers per vertex after the coordinates: normal, colour, texture
  std::string_view glued;  ///< first count, if it directly follows the format in the same word
};

/// Parses the first word, such as "OFF", "COFF", "STNOFF" or ModelNet's "OFF8".
std::optional<OffHeader> parse_header(string_view word) {
  OffHeader header;
  const auto take = [&](string_view prefix, std::size_t numbers) {
    if (!word.starts_with(prefix)) return;
    word.remove_prefix(prefix.size());
    header.extra_vertex_values += numbers;
  };
  take("ST", 2);
  take("C", 4);
  take("N", 3);
  if (!word.starts_with("OFF") && !word.starts_with("off")) return std::nullopt;
  header.glued = word.substr(3);
  if (header.glued.find_first_not_of("0123456789") != string_view::npos) return std::nullopt;
  return header;
}

class OffReader {
 public:
  OffReader(string_view name, string_view text, const MeshLimits& limits)
      : scanner_(name, text), soup_(name, limits) {}

  PolygonSoup read() {
    read_header();
    has_own_lines_ = has_line_for_each();
    for (std::uint64_t v = 0; v < vertices_; ++v) read_vertex();
    for (std::uint64_t face = 0; face < faces_; ++face) read_face();
    return std::move(soup_.soup());
  }

 private:
  /// Returns the next word outside comments, on any line.
  std::optional<string_view> next() {
    while (true) {
      const auto word = scanner_.word();
      if (!word || !word->starts_with('#')) return word;
      scanner_.next_line();
    }
  }

  /// Returns the next word, limited to the current line if each vertex and face has a separate
  /// line.
  std::optional<string_view> next_on_line() {
    if (!has_own_lines_) return next();
    const auto word = scanner_.word_in_line();
    return word && word->starts_with('#') ? std::nullopt : word;
  }

  void read_header() {
    const auto word = next();
    const std::optional<OffHeader> header = parse_header(word.value_or(""));
    if (!header) {
      scanner_.fail("a supported OFF file begins with 'OFF', 'COFF', 'NOFF' or 'STOFF'");
    }
    header_ = *header;
    const auto count = header_.glued.empty() ? next() : std::optional(header_.glued);
    if (count == "BINARY") {
      scanner_.fail("binary OFF is not supported; save it as ASCII OFF or PLY");
    }
    vertices_ = scanner_.number<std::uint64_t>(count, "the number of vertices");
    faces_ = scanner_.number<std::uint64_t>(next(), "the number of faces");
    // A vertex needs at least 6 characters, a face 2.
    if (vertices_ > scanner_.remaining() / 6 + 1 || faces_ > scanner_.remaining() / 2 + 1) {
      scanner_.fail(std::to_string(vertices_) + " vertices and " + std::to_string(faces_) +
                    " faces are declared, but the file is too short");
    }
    skip_edges();
    soup_.require(vertices_, faces_);
    soup_.soup().vertices.reserve(vertices_);
  }

  /// Skips the number of edges, which is optional and often wrong.
  void skip_edges() {
    TextScanner ahead = scanner_;
    const auto edges = ahead.word_in_line();
    if (edges && !edges->starts_with('#')) scanner_ = ahead;
    if (edges) return;
    // The count may also be on a separate line that contains nothing else.
    ahead = scanner_;
    ahead.next_line();
    const auto first = ahead.word_in_line();
    const bool is_count = first && first->find_first_not_of("0123456789") == string_view::npos;
    if (is_count && !ahead.word_in_line()) scanner_ = ahead;
  }

  /// Returns whether there is a line for each vertex and face. The first of them must be a vertex.
  bool has_line_for_each() const {
    TextScanner ahead = scanner_;
    std::uint64_t lines = 0, num_first_line_values = 0;
    while (ahead.next_line()) {
      const auto word = ahead.word_in_line();
      if (!word || word->starts_with('#')) continue;
      if (lines++ == 0) {
        num_first_line_values = 1;
        for (auto more = ahead.word_in_line(); more && !more->starts_with('#');
             more = ahead.word_in_line()) {
          ++num_first_line_values;
        }
      }
      if (lines == vertices_ + faces_) break;
    }
    // Truncated files in line format must be detected, so that the message names the line.
    const bool is_short = lines < vertices_ + faces_;
    return num_first_line_values >= 3 && (!is_short || num_first_line_values < 6);
  }

  /// Advances to the next line with content if each vertex and face has a separate line.
  void begin_thing() {
    if (!has_own_lines_) return;
    while (scanner_.next_line()) {
      TextScanner ahead = scanner_;
      const auto word = ahead.word_in_line();
      if (word && !word->starts_with('#')) return;
    }
  }

  void read_vertex() {
    begin_thing();
    Eigen::Vector3d vertex;
    for (double& coordinate : vertex) {
      coordinate = scanner_.number<double>(next_on_line(), "a coordinate");
    }
    for (std::size_t i = 0; i < header_.extra_vertex_values && !has_own_lines_; ++i) next();
    soup_.add_vertex(vertex);
  }

  void read_face() {
    begin_thing();
    const auto corners =
        scanner_.number<std::uint32_t>(next_on_line(), "the number of corners of a face");
    for (std::uint32_t i = 0; i < corners; ++i) {
      const auto vertex = scanner_.number<std::int64_t>(next_on_line(), "a vertex index");
      if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertices_) {
        scanner_.fail("the face " + no_such_vertex(vertex, vertices_));
      }
      soup_.add_corner(static_cast<std::uint32_t>(vertex));
    }
    soup_.close_polygon();
  }

  TextScanner scanner_;
  BoundedSoup soup_;
  OffHeader header_;
  std::uint64_t vertices_ = 0, faces_ = 0;
  bool has_own_lines_ = true;
};

}  // namespace

PolygonSoup parse_off(string_view name, string_view text, const MeshLimits& limits) {
  return OffReader(name, text, limits).read();
}

}  // namespace skycap::geometry
