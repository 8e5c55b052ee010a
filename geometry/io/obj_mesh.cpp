// Wavefront OBJ: polygons and materials.
#include <limits>
#include <optional>
#include <string>
#include <unordered_map>

#include "geometry/io/mesh_formats.h"
#include "geometry/io/text/text_scanner.h"

namespace skycap::geometry {
namespace {

using std::string_view;

/// Returns the name without a comment. The comment sign must be surrounded by blanks: "Glass #2" is
/// a name.
string_view without_comment(string_view name) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  for (std::size_t i = 1; i + 1 < name.size(); ++i) {
    if (name[i] == '#' && is_blank(name[i - 1]) && is_blank(name[i + 1])) {
      return trimmed(name.substr(0, i));
    }
  }
  return name;
}

class ObjReader {
 public:
  ObjReader(string_view name, string_view text, const MeshLimits& limits)
      : scanner_(name, text), max_materials_(limits.materials), polygons_(name, limits) {}

  PolygonSoup read() {
    do {
      const auto keyword = scanner_.word_in_line();
      if (!keyword || keyword->starts_with('#')) continue;
      read_statement(*keyword);
    } while (scanner_.next_line());
    check_corners();
    return std::move(soup_);
  }

 private:
  void read_statement(string_view keyword) {
    if (keyword == "v" || keyword == "V") return read_vertex();
    if (keyword == "f" || keyword == "F" || keyword == "fo") return read_face();
    if (keyword == "usemtl") return read_material();
    if (keyword == "surf") {
      scanner_.fail("free-form surfaces (surf) are not supported; save the model as polygons");
    }
    if (keyword == "call" || keyword == "csh") {
      scanner_.fail("'" + std::string(keyword) +
                    "' includes another file, which is not supported; save the model as one file");
    }
  }

  /// Returns the next word of a statement. A backslash continues the statement on the next line.
  std::optional<string_view> next() {
    while (true) {
      auto word = scanner_.word_in_line();
      if (!word || word->starts_with('#')) return std::nullopt;
      if (!word->ends_with('\\')) return word;
      word->remove_suffix(1);
      const bool has_more = scanner_.next_line();
      if (!word->empty()) return word;
      if (!has_more) return std::nullopt;
    }
  }

  void read_vertex() {
    Eigen::Vector3d vertex;
    for (double& coordinate : vertex) {
      coordinate = scanner_.number<double>(next(), "a coordinate");
    }
    polygons_.add_vertex(vertex);
  }

  void read_material() {
    // Faces before the first usemtl get the unnamed material.
    if (soup_.materials.empty() && !lines_.empty()) use_material("");
    soup_.polygon_materials.resize(lines_.size(), 0);
    use_material(std::string(without_comment(scanner_.remaining_line())));
  }

  void use_material(const std::string& material) {
    const auto number = static_cast<std::uint32_t>(soup_.materials.size());
    const auto [known, is_new] = materials_.emplace(material, number);
    if (is_new && number == max_materials_) {
      scanner_.fail("names more than " + std::to_string(max_materials_) + " materials");
    }
    material_ = known->second;
    if (is_new) soup_.materials.push_back(material);
  }

  void read_face() {
    if (!soup_.materials.empty()) soup_.polygon_materials.push_back(material_);
    lines_.push_back(static_cast<std::uint32_t>(scanner_.line()));
    while (const auto corner = next()) polygons_.add_corner(parse_vertex(*corner));
    polygons_.close_polygon();
  }

  std::uint32_t parse_vertex(string_view corner) {
    const auto position = corner.substr(0, corner.find('/'));
    const auto index = scanner_.number<std::int64_t>(position, "a vertex index");
    // Indices are one-based, or negative relative to the latest vertex.
    const auto count = static_cast<std::int64_t>(soup_.vertices.size());
    const std::int64_t vertex = index > 0 ? index - 1 : index + count;
    if (index == 0 || vertex < 0 || vertex > std::numeric_limits<std::uint32_t>::max()) {
      scanner_.fail("the face refers to vertex " + std::to_string(index) + ", but " +
                    std::to_string(count) +
                    " vertices precede it; indices count from 1, or backwards from -1");
    }
    return static_cast<std::uint32_t>(vertex);
  }

  /// Checks all corners at the end, because faces may precede their vertices.
  void check_corners() const {
    for (std::size_t polygon = 0; polygon < lines_.size(); ++polygon) {
      for (std::size_t i = soup_.polygon_begin[polygon]; i < soup_.polygon_begin[polygon + 1];
           ++i) {
        if (soup_.corners[i] < soup_.vertices.size()) continue;
        scanner_.fail_at(lines_[polygon], "the face refers to vertex " +
                                              std::to_string(soup_.corners[i] + std::uint64_t{1}) +
                                              ", but there are only " +
                                              std::to_string(soup_.vertices.size()));
      }
    }
  }

  TextScanner scanner_;
  std::size_t max_materials_;
  BoundedSoup polygons_;
  PolygonSoup& soup_ = polygons_.soup();
  std::vector<std::uint32_t> lines_;  // line of each polygon, for messages of check_corners()
  std::uint32_t material_ = 0;
  std::unordered_map<std::string, std::uint32_t> materials_;  // material numbers by name
};

}  // namespace

PolygonSoup parse_obj(string_view name, string_view text, const MeshLimits& limits) {
  return ObjReader(name, text, limits).read();
}

}  // namespace skycap::geometry
