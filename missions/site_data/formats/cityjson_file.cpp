#include <array>
#include <cmath>
#include <cstdint>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/json.h"
#include "geometry/io/text/plain_text.h"
#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::json;

constexpr std::size_t max_json_corners = 16'000'000;

SurfaceKind kind_named(const std::string& name) {
  if (name == "WallSurface") return SurfaceKind::wall;
  if (name == "RoofSurface") return SurfaceKind::roof;
  if (name == "GroundSurface") return SurfaceKind::ground;
  if (name == "Window" || name == "Door") return SurfaceKind::opening;
  return SurfaceKind::other;
}

bool is_inside_a_building(const std::string& type) {
  return type == "BuildingRoom" || type == "BuildingFurniture" || type == "Room" ||
         type == "InteriorWallSurface" || type == "CeilingSurface" || type == "FloorSurface" ||
         type == "ClosureSurface";
}

/// Conversion of a geometry's vertices to coordinates.
struct VertexTransform {
  const Json* vertices = nullptr;
  Vector3d scale = Vector3d::Ones(), translation = Vector3d::Zero();

  Vector3d at(std::size_t index) const {
    const Json& vertex = vertices->at(index);
    Vector3d corner;
    for (int axis = 0; axis < 3; ++axis) {
      corner[axis] =
          vertex.at(static_cast<std::size_t>(axis)).get<double>() * scale[axis] + translation[axis];
    }
    return corner;
  }
};

Vector3d to_vector(const Json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

/// Returns the nesting depth of the surfaces in the boundaries of a geometry type; empty for types
/// without surfaces.
std::optional<int> find_nesting_depth(const std::string& type) {
  if (type == "MultiSurface" || type == "CompositeSurface") return 0;
  if (type == "Solid") return 1;
  if (type == "MultiSolid" || type == "CompositeSolid") return 2;
  return std::nullopt;
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, FileContents& contents)
      : file_(file), contents_(contents) {}

  void read_header(const Json& root);
  void read_objects(const Json& root);
  void finish();

 private:
  void read_geometry(const Json& geometry, FileObject& object);
  void read_boundaries(const Json& boundaries, int nesting, const Json* values);
  void read_surface(const Json& rings, const Json* value);
  std::optional<double> read_detail_level(const Json& geometry);
  const Json* find_surface(const Json* value);
  void read_instance(const Json& geometry, FileObject& object);

  const std::filesystem::path& file_;
  FileContents& contents_;
  Vector3d scale_ = Vector3d::Ones(), translation_ = Vector3d::Zero();
  Json templates_;  ///< geometry-templates
  std::size_t polygons_ = 0, left_out_ = 0, without_surfaces_ = 0, without_level_ = 0,
              without_kind_ = 0;

  // State of the geometry that is being read.
  FileObject* object_ = nullptr;
  VertexTransform transform_;
  Eigen::Affine3d placed_ = Eigen::Affine3d::Identity();
  std::optional<double> lod_;
  const Json* surfaces_ = nullptr;  ///< Semantics of the surfaces.
};

void Reader::read_header(const Json& root) {
  contents_.format = "CityJSON " + root.value("version", std::string("1.0"));
  if (const auto metadata = root.find("metadata"); metadata != root.end()) {
    if (const auto crs = metadata->find("referenceSystem"); crs != metadata->end()) {
      contents_.crs = crs->is_string() ? crs->get<std::string>() : "";
    } else if (const auto old = metadata->find("crs"); old != metadata->end()) {
      contents_.crs = "EPSG:" + std::to_string(old->at("epsg").get<int>());  // Version 0.x.
    }
  }
  if (const auto transform = root.find("transform"); transform != root.end()) {
    scale_ = to_vector(transform->at("scale"));
    translation_ = to_vector(transform->at("translate"));
  }
  if (const auto found = root.find("geometry-templates"); found != root.end()) templates_ = *found;
}

void Reader::read_objects(const Json& root) {
  std::map<std::string, std::size_t> object_indices;
  const Json& objects = root.at("CityObjects");
  const std::size_t first = contents_.objects.size();
  for (const auto& [id, value] : objects.items()) {
    FileObject& object = contents_.objects.emplace_back();
    object.id = id;
    object.kind = value.at("type").get<std::string>();
    object_indices[id] = contents_.objects.size() - 1;
    if (const auto found = value.find("attributes"); found != value.end()) {
      for (const auto& [key, attribute] : found->items()) {
        if (attribute.is_structured() || attribute.is_null()) continue;
        object.attributes[key] =
            attribute.is_string() ? attribute.get<std::string>() : attribute.dump();
      }
    }
  }
  std::size_t i = first;
  for (const auto& [id, value] : objects.items()) {
    FileObject& object = contents_.objects[i++];
    if (const auto parents = value.find("parents"); parents != value.end() && !parents->empty()) {
      const auto parent = object_indices.find(parents->at(0).get<std::string>());
      if (parent != object_indices.end()) object.parent = parent->second;
    }
    if (is_inside_a_building(object.kind)) {
      ++left_out_;
      continue;
    }
    const auto geometries = value.find("geometry");
    if (geometries == value.end()) continue;
    if (geometries->is_null()) continue;
    try {
      for (const Json& geometry : *geometries) {
        transform_ = {&root.at("vertices"), scale_, translation_};
        placed_.setIdentity();
        read_geometry(geometry, object);
      }
    } catch (const Json::exception& error) {
      fail_file(file_, "violates the CityJSON specification in the object " + id.substr(0, 100) +
                           " (" + error.what() + ")");
    }
  }
}

/// Returns the level of detail, which may be a number or a string. Empty for geometries that belong
/// to all levels.
std::optional<double> Reader::read_detail_level(const Json& geometry) {
  const auto found = geometry.find("lod");
  if (found == geometry.end()) return std::nullopt;
  std::optional<double> level;
  if (found->is_number()) level = found->get<double>();
  if (found->is_string()) {
    std::string text = geometry::lower_case(geometry::trimmed(found->get<std::string>()));
    if (text.starts_with("lod")) text.erase(0, 3);
    level = geometry::number_in(geometry::trimmed(text));
  }
  if (level && std::isfinite(*level) && *level >= 0.0) return level;
  ++without_level_;
  return std::nullopt;
}

void Reader::read_geometry(const Json& geometry, FileObject& object) {
  const std::string type = geometry.at("type").get<std::string>();
  if (type == "GeometryInstance") return read_instance(geometry, object);
  const std::optional<int> nesting = find_nesting_depth(type);
  if (!nesting) {
    ++without_surfaces_;
    return;
  }
  object_ = &object;
  lod_ = read_detail_level(geometry);
  const Json* values = nullptr;
  surfaces_ = nullptr;
  if (const auto semantics = geometry.find("semantics"); semantics != geometry.end()) {
    const auto find_list = [&](const char* key) -> const Json* {
      if (!semantics->is_object()) return nullptr;
      const auto list = semantics->find(key);
      return list != semantics->end() && list->is_array() ? &*list : nullptr;
    };
    surfaces_ = find_list("surfaces");
    values = find_list("values");
    if (surfaces_ == nullptr || values == nullptr) ++without_kind_;
  }
  read_boundaries(geometry.at("boundaries"), *nesting, values);
}

void Reader::read_instance(const Json& geometry, FileObject& object) {
  const Json& numbers = geometry.at("transformationMatrix");
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) {
    matrix(i / 4, i % 4) = numbers.at(static_cast<std::size_t>(i)).get<double>();
  }
  placed_.matrix() = matrix;
  placed_.pretranslate(transform_.at(geometry.at("boundaries").at(0).get<std::size_t>()));
  const Json& original = templates_.at("templates").at(geometry.at("template").get<std::size_t>());
  if (original.at("type") == "GeometryInstance") {
    fail_file(file_, "has a geometry template that contains another template");
  }
  transform_ = {&templates_.at("vertices-templates"), Vector3d::Ones(), Vector3d::Zero()};
  read_geometry(original, object);
}

void Reader::read_boundaries(const Json& boundaries, int nesting, const Json* values) {
  for (std::size_t i = 0; i < boundaries.size(); ++i) {
    const Json* const value =
        values != nullptr && values->is_array() && i < values->size() ? &values->at(i) : nullptr;
    if (nesting > 0) {
      read_boundaries(boundaries.at(i), nesting - 1, value);
    } else {
      read_surface(boundaries.at(i), value);
    }
  }
}

/// Returns the semantics of a surface, or null.
const Json* Reader::find_surface(const Json* value) {
  if (value == nullptr || !value->is_number_integer() || surfaces_ == nullptr) return nullptr;
  const auto index = value->get<std::int64_t>();
  const bool is_there = index >= 0 && index < std::ssize(*surfaces_) &&
                        surfaces_->at(static_cast<std::size_t>(index)).is_object();
  if (is_there) return &surfaces_->at(static_cast<std::size_t>(index));
  ++without_kind_;
  return nullptr;
}

void Reader::read_surface(const Json& rings, const Json* value) {
  SurfaceKind kind = SurfaceKind::unknown;
  if (const Json* const surface = find_surface(value)) {
    const std::string type = surface->value("type", std::string());
    if (is_inside_a_building(type)) {
      ++left_out_;
      return;
    }
    kind = kind_named(type);
  }
  if (++polygons_ > max_polygons) fail_file(file_, "has more than 50 million polygons");
  FilePolygon& polygon = contents_.add_polygon(*object_);
  polygon.kind = kind;
  polygon.lod = lod_;
  for (const Json& ring : rings) {
    if (contents_.corners.size() + ring.size() > max_json_corners) {
      fail_file(file_, "has more than 16 million polygon corners; split the file");
    }
    for (const Json& index : ring) {
      contents_.corners.push_back(placed_ * transform_.at(index.get<std::size_t>()));
    }
    contents_.close_ring(polygon);
  }
}

void Reader::finish() {
  if (left_out_ > 0) {
    contents_.notes.push_back(std::to_string(left_out_) +
                              " rooms, interior surfaces and closure surfaces ignored");
  }
  if (without_surfaces_ > 0) {
    contents_.notes.push_back(std::to_string(without_surfaces_) +
                              " geometries ignored (points or lines)");
  }
  if (without_level_ > 0) {
    contents_.notes.push_back(std::to_string(without_level_) +
                              " geometries have an invalid lod and are used for all levels");
  }
  if (without_kind_ > 0) {
    contents_.notes.push_back(std::to_string(without_kind_) +
                              " semantics are incomplete (surfaces without a type)");
  }
}

/// Returns the memory required for the text and its tree. Values have 16 bytes in lists that double
/// as they grow. Lists, maps and strings include heap overhead.
std::size_t json_tree_bytes(std::string_view json) {
  std::size_t bytes = json.size();
  for (const char c : json) {
    if (c == ',') bytes += 32;
    if (c == '[' || c == '{') bytes += 64;
    if (c == ':') bytes += 80;
    if (c == '"') bytes += 24;
  }
  return bytes;
}

/// Parses a file of one JSON text, or of one text per line.
std::vector<Json> parse_documents(const std::filesystem::path& file, std::string_view bytes) {
  std::vector<Json> texts;
  texts.push_back(geometry::parse_json<Json>(bytes));
  if (!texts[0].is_discarded()) return texts;
  texts.clear();
  for (std::size_t begin = 0, line = 1; begin < bytes.size(); ++line) {
    const std::size_t end = std::min(bytes.find('\n', begin), bytes.size());
    const std::string_view text = bytes.substr(begin, end - begin);
    begin = end + 1;
    if (text.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    texts.push_back(geometry::parse_json<Json>(text));
    if (!texts.back().is_discarded()) continue;
    fail_file(file, line == 1 ? "is not JSON" : "line " + std::to_string(line) + " is not JSON");
  }
  return texts;
}

}  // namespace

FileContents parse_cityjson(const std::filesystem::path& file, std::string_view bytes) {
  require_tree_fits(file, json_tree_bytes(bytes));
  const std::vector<Json> texts = parse_documents(file, bytes);
  FileContents contents;
  try {
    Reader reader(file, contents);
    if (texts.empty()) fail_file(file, "is empty; expected a CityJSON file");
    reader.read_header(texts.at(0));
    for (const Json& text : texts) reader.read_objects(text);
    reader.finish();
    if (texts.size() > 1) contents.format = "CityJSONSeq " + contents.format.substr(9);
  } catch (const Json::exception& error) {
    fail_file(file, std::string("violates the CityJSON specification (") + error.what() + ")");
  }
  return contents;
}

}  // namespace skycap::missions::site_data
