#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>

#include <pugixml.hpp>

#include "geometry/error.h"
#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/formats/gml_numbers.h"

namespace skycap::missions::site_data {
namespace {

constexpr int deepest = 200;  // Maximum nesting; real files have up to 25 levels.

using Name = std::string_view;

Name local_name(const char* qualified) {
  const Name name(qualified);
  const std::size_t colon = name.rfind(':');
  return colon == Name::npos ? name : name.substr(colon + 1);
}

template <std::size_t n>
bool is_one_of(Name name, const std::array<Name, n>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_polygon(Name name) {
  return is_one_of(name, std::array<Name, 4>{"Polygon", "Triangle", "Rectangle", "PolygonPatch"});
}

/// Returns true for elements that are inside buildings, virtual, or in their own coordinates.
bool is_left_out(Name name) {
  return is_one_of(
      name, std::array<Name, 10>{"ClosureSurface", "Room", "BuildingRoom", "InteriorWallSurface",
                                 "CeilingSurface", "FloorSurface", "IntBuildingInstallation",
                                 "BuildingFurniture", "relativeGMLGeometry", "relativeGeometry"});
}

/// Returns true for elements that have identifiers but are not objects.
bool is_no_feature(Name name) {
  return is_one_of(
      name, std::array<Name, 8>{"CityModel", "Address", "Envelope", "Appearance",
                                "TriangulatedSurface", "Tin", "MultiSurface", "FeatureCollection"});
}

SurfaceKind kind_named(Name name) {
  if (name == "WallSurface") return SurfaceKind::wall;
  if (name == "RoofSurface") return SurfaceKind::roof;
  if (name == "GroundSurface") return SurfaceKind::ground;
  if (is_one_of(name, std::array<Name, 6>{"Window", "Door", "WindowSurface", "DoorSurface",
                                          "Opening", "_Opening"})) {
    return SurfaceKind::opening;
  }
  if (is_one_of(name,
                std::array<Name, 5>{"OuterCeilingSurface", "OuterFloorSurface",
                                    "GenericThematicSurface", "TrafficSurface", "WaterSurface"})) {
    return SurfaceKind::other;
  }
  return SurfaceKind::unknown;
}

/// Parses the level of detail, for example 2 in "lod2MultiSurface".
std::optional<double> read_detail_level(Name name) {
  if (!name.starts_with("lod") || name.size() < 4 || name[3] < '0' || name[3] > '9') {
    return std::nullopt;
  }
  return name[3] - '0';
}

pugi::xml_attribute attribute(pugi::xml_node node, Name name) {
  for (const pugi::xml_attribute candidate : node.attributes()) {
    if (local_name(candidate.name()) == name) return candidate;
  }
  return {};
}

pugi::xml_node child(pugi::xml_node node, Name name) {
  for (const pugi::xml_node candidate : node.children()) {
    if (local_name(candidate.name()) == name) return candidate;
  }
  return {};
}

/// Context of an element, from the enclosing elements.
struct Surroundings {
  std::optional<std::size_t> object;
  SurfaceKind kind = SurfaceKind::unknown;
  std::optional<double> lod;
  int dimension = 3;
  bool is_done = false;  ///< The contents are not needed or were already read.
  bool is_address = false;
};

class Walker final : public pugi::xml_tree_walker {
 public:
  Walker(const std::filesystem::path& file, FileContents& contents, std::size_t max_objects)
      : file_(file), contents_(contents), max_objects_(max_objects) {
    around_.emplace_back();
  }

  bool for_each(pugi::xml_node& node) override {
    const auto depth_here = static_cast<std::size_t>(depth());
    if (depth() > deepest) {
      fail_file(file_, "is nested deeper than " + std::to_string(deepest) + " elements");
    }
    around_.resize(depth_here + 1);
    Surroundings here = around_[depth_here];
    if (node.type() == pugi::node_element && !here.is_done) enter(node, here);
    around_.push_back(here);
    return true;
  }

  /// Completes data that is known only at the end: kinds of polygons referenced by walls or roofs.
  void finish();

 private:
  void enter(pugi::xml_node node, Surroundings& here);
  void read_reference_system(pugi::xml_node node);
  void enter_object(pugi::xml_node node, Name name, Surroundings& here);
  void read_attribute(pugi::xml_node node, Name name, const Surroundings& here);
  void read_polygon(pugi::xml_node node, Surroundings& here);
  void read_ring(pugi::xml_node boundary, int dimension);
  void read_positions(pugi::xml_node part, int& dimension);

  struct PolygonIndex {
    std::size_t object, polygon;
  };

  const std::filesystem::path& file_;
  FileContents& contents_;
  std::size_t max_objects_;
  /// Contexts of the elements from the root to the current one.
  std::vector<Surroundings> around_;
  std::map<std::string, std::size_t> left_out_;
  std::unordered_map<std::string, SurfaceKind> surface_kinds_;  ///< Kinds by referenced identifier.
  std::unordered_map<std::string, PolygonIndex> unknown_;       ///< Polygons without a kind.
  std::size_t polygons_ = 0, rings_without_position_ = 0, rings_without_heights_ = 0;
  std::vector<double> numbers_;  // Member to reuse its memory.
};

void Walker::enter(pugi::xml_node node, Surroundings& here) {
  const Name name = local_name(node.name());
  read_reference_system(node);
  if (const pugi::xml_attribute dimension = attribute(node, "srsDimension")) {
    here.dimension = dimension.as_int();
  }
  if (is_left_out(name)) {
    ++left_out_[std::string(name)];
    here.is_done = true;
    return;
  }
  if (name == "appearanceMember" || name == "appearance") {
    here.is_done = true;
    return;
  }
  if (is_polygon(name)) {
    read_polygon(node, here);
    return;
  }
  if (const std::optional<double> lod = read_detail_level(name)) here.lod = lod;
  const SurfaceKind kind = kind_named(name);
  if (kind != SurfaceKind::unknown) here.kind = kind;
  if (here.kind != SurfaceKind::unknown) {
    const pugi::xml_attribute reference = attribute(node, "href");
    if (Name(reference.as_string()).starts_with('#')) {
      surface_kinds_.emplace(reference.as_string() + 1, here.kind);
    }
  }
  if (name == "Address") here.is_address = true;
  read_attribute(node, name, here);
  enter_object(node, name, here);
}

/// Sets the reference system that an element defines for its contents.
void Walker::read_reference_system(pugi::xml_node node) {
  const std::string crs = attribute(node, "srsName").as_string();
  if (crs.empty() || crs == contents_.crs) return;
  (contents_.crs.empty() ? contents_.crs : contents_.other_crs) = crs;
}

void Walker::enter_object(pugi::xml_node node, Name name, Surroundings& here) {
  if (here.lod || here.kind != SurfaceKind::unknown || is_no_feature(name)) return;
  const pugi::xml_attribute id = attribute(node, "id");
  const Name around = local_name(node.parent().name());
  const bool is_member = around == "cityObjectMember" || around == "featureMember";
  if (!id && !is_member) return;
  if (contents_.objects.size() == max_objects_) {
    fail_file(file_, "has more than " + std::to_string(max_objects_) + " objects");
  }
  FileObject& object = contents_.objects.emplace_back();
  object.id = id ? id.as_string() : std::to_string(contents_.objects.size());
  object.kind = name;
  object.parent = here.object;
  here.object = contents_.objects.size() - 1;
}

void Walker::read_attribute(pugi::xml_node node, Name name, const Surroundings& here) {
  if (!here.object) return;
  std::map<std::string, std::string>& attributes = contents_.objects[*here.object].attributes;
  if (const pugi::xml_node value = child(node, "value"); value && name.ends_with("Attribute")) {
    const pugi::xml_attribute key = attribute(node, "name");
    attributes.emplace(key ? key.as_string() : child(node, "name").child_value(),
                       value.child_value());
    return;
  }
  const pugi::xml_node text = node.first_child();
  if (text.type() != pugi::node_pcdata || text.next_sibling()) return;
  const bool is_own =
      attribute(node.parent(), "id").as_string() == Name(contents_.objects[*here.object].id);
  if (is_own || here.is_address) attributes.emplace(name, text.value());
}

void Walker::read_polygon(pugi::xml_node node, Surroundings& here) {
  here.is_done = true;
  if (++polygons_ > max_polygons) fail_file(file_, "has more than 50 million polygons");
  if (!here.object) {
    contents_.objects.emplace_back().id = std::to_string(contents_.objects.size());
    here.object = contents_.objects.size() - 1;
    for (Surroundings& around : around_) around.object = here.object;
  }
  FileObject& object = contents_.objects[*here.object];
  FilePolygon& polygon = contents_.add_polygon(object);
  polygon.kind = here.kind;
  polygon.lod = here.lod;
  if (const pugi::xml_attribute dimension = attribute(node, "srsDimension")) {
    here.dimension = dimension.as_int();
  }
  for (const bool is_outline : {true, false}) {
    for (const pugi::xml_node part : node.children()) {
      const Name name = local_name(part.name());
      const bool is_exterior = name == "exterior" || name == "outerBoundaryIs";
      const bool is_interior = name == "interior" || name == "innerBoundaryIs";
      if (is_outline ? is_exterior : is_interior) {
        read_ring(part, here.dimension);
        contents_.close_ring(polygon);
      }
    }
  }
  if (here.kind == SurfaceKind::unknown) {
    if (const pugi::xml_attribute id = attribute(node, "id")) {
      unknown_.emplace(id.as_string(), PolygonIndex{*here.object, object.polygons.size() - 1});
    }
  }
}

/// Reads the corners of a ring. Rings with curves or without heights are empty, so that they have
/// no area.
void Walker::read_ring(pugi::xml_node boundary, int dimension) {
  const pugi::xml_node ring = child(boundary, "LinearRing");
  read_reference_system(ring);
  if (const pugi::xml_attribute own = attribute(ring, "srsDimension")) dimension = own.as_int();
  numbers_.clear();
  for (const pugi::xml_node part : ring.children()) {
    const Name name = local_name(part.name());
    if (name == "pointProperty" || name == "pointRep") {
      const pugi::xml_node point = child(part, "Point");
      read_reference_system(point);
      for (const pugi::xml_node position : point.children()) read_positions(position, dimension);
    } else {
      read_positions(part, dimension);
    }
  }
  if (dimension != 2 && dimension != 3) {
    fail_file(file_, "has coordinates with " + std::to_string(dimension) +
                         " dimensions (srsDimension); only 2 and 3 are supported");
  }
  const auto width = static_cast<std::size_t>(dimension);
  if (dimension == 2 && !numbers_.empty()) {
    ++rings_without_heights_;
    return;
  }
  if (numbers_.size() % width != 0) {
    fail_file(file_, "has a ring of " + std::to_string(numbers_.size()) +
                         " numbers, which is not a multiple of " + std::to_string(dimension));
  }
  if (numbers_.empty()) ++rings_without_position_;
  if (contents_.corners.size() + numbers_.size() / width > max_corners) {
    fail_file(file_, "has more than 1 billion corners");
  }
  for (std::size_t i = 0; i < numbers_.size(); i += width) {
    contents_.corners.emplace_back(numbers_[i], numbers_[i + 1], numbers_[i + 2]);
  }
}

/// Reads pos, posList or coordinates. An element `coordinates` may define separators (GML 3.1.1,
/// 9.1).
void Walker::read_positions(pugi::xml_node part, int& dimension) {
  const Name name = local_name(part.name());
  if (name != "posList" && name != "pos" && name != "coordinates") return;
  read_reference_system(part);
  if (const pugi::xml_attribute own = attribute(part, "srsDimension")) dimension = own.as_int();
  GmlSeparators separators;
  if (name == "coordinates") {
    separators = {attribute(part, "decimal").as_string(), attribute(part, "cs").as_string(),
                  attribute(part, "ts").as_string()};
  }
  for (const pugi::xml_node text : part.children()) {
    append_gml_numbers(file_, text.value(), separators, numbers_);
  }
}

void Walker::finish() {
  for (const auto& [id, polygon] : unknown_) {
    const auto kind = surface_kinds_.find(id);
    if (kind == surface_kinds_.end()) continue;
    contents_.objects[polygon.object].polygons[polygon.polygon].kind = kind->second;
  }
  for (const auto& [name, count] : left_out_) {
    contents_.notes.push_back(std::to_string(count) + " " + name + " ignored");
  }
  if (rings_without_position_ > 0) {
    contents_.notes.push_back(std::to_string(rings_without_position_) +
                              " rings ignored (not composed of straight lines)");
  }
  if (rings_without_heights_ == 0) return;
  if (contents_.corners.empty()) {
    fail_file(file_, "has only coordinates without heights (srsDimension 2)");
  }
  contents_.notes.push_back(std::to_string(rings_without_heights_) +
                            " rings ignored (no heights, srsDimension 2)");
}

/// Returns the version from the namespaces of the root.
std::string read_version(pugi::xml_node root) {
  for (const char* version : {"3.0", "2.0", "1.0"}) {
    for (const pugi::xml_attribute attribute : root.attributes()) {
      const Name value(attribute.value());
      if (value.find("citygml") != Name::npos && value.ends_with(version)) {
        return "CityGML " + std::string(version);
      }
    }
  }
  return "CityGML";
}

/// Returns true for names of authorities, for which GML defines the axis order latitude first.
/// Short names do not imply it.
bool is_by_authority(Name crs) { return crs.starts_with("urn:") || crs.starts_with("http"); }

/// Returns the memory required for the text, its tree and its corners: 64 bytes per pugixml node
/// and 40 per attribute, copies of texts, and 24 bytes per corner, doubled while the list grows.
std::size_t xml_tree_bytes(std::string_view xml) {
  std::size_t bytes = xml.size();
  const auto is_gap = [](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; };
  for (std::size_t i = 0; i + 1 < xml.size(); ++i) {
    const char c = xml[i], next = xml[i + 1];
    if (c == '<' && next != '/') bytes += 64;
    if (c == '>' && next != '<' && !is_gap(next)) bytes += 128;
    if (c == '=') bytes += 40;
    if ((is_gap(c) || c == ',') && next != '<' && !is_gap(next)) bytes += 16;
  }
  return bytes;
}

}  // namespace

FileContents parse_citygml(const std::filesystem::path& file, std::string bytes,
                           std::size_t max_objects) {
  require_tree_fits(file, xml_tree_bytes(bytes));
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer_inplace(
      bytes.data(), bytes.size(), pugi::parse_escapes | pugi::parse_cdata);
  if (!result) {
    const auto end = bytes.begin() + std::min<std::ptrdiff_t>(result.offset, std::ssize(bytes));
    fail_file(file, "is not valid XML from line " +
                        std::to_string(1 + std::count(bytes.begin(), end, '\n')) + " on (" +
                        result.description() + ")");
  }
  const pugi::xml_node root = document.document_element();
  FileContents contents;
  contents.format = read_version(root);
  Walker walker(file, contents, max_objects);
  document.traverse(walker);
  walker.finish();
  contents.is_latitude_first = is_by_authority(contents.crs);
  return contents;
}

}  // namespace skycap::missions::site_data
