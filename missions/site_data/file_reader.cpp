#include "missions/site_data/file_reader.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/file.h"
#include "geometry/io/mesh_io.h"
#include "geometry/io/text/plain_text.h"
#include "missions/site_data/formats/building_heights.h"
#include "missions/site_data/formats/cell_set.h"
#include "missions/site_data/formats/cloud_files.h"
#include "missions/site_data/formats/dxf_header.h"
#include "missions/site_data/formats/geodata_file.h"
#include "missions/site_data/formats/scene_facts.h"
#include "missions/site_data/site_transform.h"

namespace skycap::missions::site_data {
namespace {

using std::string_view;
namespace fs = std::filesystem;

enum class Format { citygml, cityjson, map, raster, las, e57, scene, mesh, cloud };

bool is_one_of(string_view text, std::initializer_list<string_view> wanted) {
  return std::ranges::find(wanted, text) != wanted.end();
}

bool begins_with_one_of(string_view text, std::initializer_list<string_view> wanted) {
  return std::ranges::any_of(wanted, [&](string_view begin) { return text.starts_with(begin); });
}

/// Returns the local name of the root element; empty if the text is not XML.
string_view root_of(string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == string_view::npos || text[first] != '<') return {};
  std::size_t place = first;
  while (place + 1 < text.size() && (text[place + 1] == '?' || text[place + 1] == '!')) {
    const bool is_comment = text.substr(place).starts_with("<!--");
    place = text.find(is_comment ? "-->" : ">", place);
    if (place != string_view::npos) place = text.find('<', place);
    if (place == string_view::npos) return {};
  }
  const std::size_t end = std::min(text.find_first_of(" \t\r\n/>", place + 1), text.size());
  string_view name = text.substr(place + 1, end - place - 1);
  return name.substr(name.rfind(':') + 1);
}

std::optional<Format> format_of_xml(string_view root, string_view text) {
  if (root == "CityModel") return Format::citygml;
  if (root == "FeatureCollection" && text.find("citygml") != string_view::npos) {
    return Format::citygml;  // Response format of feature servers.
  }
  if (root == "kml" || root == "osm") return Format::map;
  if (root == "COLLADA") return Format::scene;
  return std::nullopt;
}

/// Detects Arc/Info grids by the keywords that GDAL recognises. Other text in .asc files is a
/// cloud.
bool is_ascii_grid(string_view beginning) {
  const std::string text = geometry::lower_case(beginning.substr(0, 40));
  return begins_with_one_of(text, {"ncols", "nrows", "xllcorner", "yllcorner", "xllcenter",
                                   "yllcenter", "cellsize", "dx ", "dy "});
}

std::optional<Format> format_by_content(string_view beginning) {
  using namespace std::string_view_literals;
  if (beginning.starts_with("LASF")) return Format::las;
  if (beginning.starts_with("ASTM-E57")) return Format::e57;
  if (begins_with_one_of(beginning, {"glTF", "Kaydara FBX", "; FBX"}) ||
      geometry::trimmed(beginning).starts_with("ISO-10303-21")) {
    return Format::scene;
  }
  if (begins_with_one_of(beginning, {"SQLite format 3", "\0\0\x27\x0A"sv, "fgb\3fgb"})) {
    return Format::map;
  }
  if (begins_with_one_of(beginning,
                         {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv, "\0\0\0\x0CjP"sv}) ||
      is_ascii_grid(beginning)) {
    return Format::raster;
  }
  if (begins_with_one_of(beginning, {"ply\n", "ply\r"})) {
    const bool has_faces = beginning.find("element face") != string_view::npos ||
                           beginning.find("element tristrips") != string_view::npos;
    return has_faces ? Format::mesh : Format::cloud;
  }
  if (begins_with_one_of(beginning, {"# .PCD", "VERSION"})) return Format::cloud;
  if (begins_with_one_of(beginning, {"OFF", "DRACO"})) return Format::mesh;
  return format_of_xml(root_of(beginning), beginning);
}

std::optional<Format> format_by_ending(const std::string& ending, Role role) {
  if (is_one_of(ending, {".obj", ".off", ".stl", ".drc", ".ply"})) return Format::mesh;
  if (is_one_of(ending, {".pcd", ".txt", ".asc", ".pts", ".csv"})) return Format::cloud;
  if (is_one_of(ending, {".dae", ".fbx", ".3ds", ".ifc", ".gltf", ".glb"})) return Format::scene;
  if (is_one_of(ending, {".dxf", ".pbf", ".shp", ".geojson", ".fgb", ".gpkg", ".kmz"})) {
    return Format::map;
  }
  if (is_one_of(ending, {".tif", ".tiff", ".jp2"})) return Format::raster;
  // Terrain is commonly distributed as gridded lines of x y z.
  if (ending == ".xyz") return role == Role::terrain ? Format::raster : Format::cloud;
  return std::nullopt;
}

/// Returns the position after the closing quote of the JSON string that starts at `quote`.
std::size_t end_of_string(string_view text, std::size_t quote) {
  std::size_t place = quote + 1;
  while (place < text.size() && text[place] != '"') place += text[place] == '\\' ? 2 : 1;
  return std::min(place + 1, text.size());
}

/// Type information in the outermost object of a JSON text.
struct JsonKind {
  string_view type;        ///< Value of the key "type".
  bool has_asset = false;  ///< Has the key "asset", which glTF requires.
};

JsonKind kind_of_json(string_view text) {
  JsonKind kind;
  int depth = 0;
  string_view key;  // Key of the next value.
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    if (depth == 0 && c == '}') break;
    if (c == ',' && depth == 1) key = {};
    if (c != '"') continue;
    const std::size_t end = end_of_string(text, i);
    const string_view quoted = text.substr(i + 1, end - i - 2);
    i = end - 1;
    if (depth != 1) continue;
    if (!key.empty()) {
      if (key == "type") kind.type = quoted;
      continue;
    }
    key = quoted;
    kind.has_asset |= key == "asset";
  }
  return kind;
}

Format format_of_json(const std::string& ending, string_view text) {
  const JsonKind kind = kind_of_json(text);
  if (is_one_of(kind.type, {"CityJSON", "CityJSONFeature"})) return Format::cityjson;
  const bool is_gltf = ending == ".gltf" || (kind.has_asset && kind.type.empty());
  return is_gltf ? Format::scene : Format::map;
}

std::string beginning_of(const fs::path& file) {
  std::string bytes(1 << 16, '\0');
  std::ifstream stream = geometry::open_stream(file);
  if (!stream) fail_file(file, "cannot be opened");
  stream.read(bytes.data(), std::ssize(bytes));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

// Parse trees of CityGML take three times the size of the text, those of CityJSON up to twenty
// times.
constexpr std::size_t largest_citygml = std::size_t{512} << 20,
                      largest_cityjson = std::size_t{128} << 20;

struct Opened {
  Format format;
  std::string bytes;  ///< Complete contents, for formats that are parsed as a whole.
};

Opened open_file(const fs::path& file, Role role) {
  std::error_code failure;
  if (!fs::is_regular_file(file, failure))
    fail_file(file, "does not exist, or is not a regular file");
  const std::string beginning = beginning_of(file);
  const bool is_read_piece_by_piece = begins_with_one_of(beginning, {"LASF", "ASTM-E57"});
  if (!is_read_piece_by_piece && fs::file_size(file, failure) > most_bytes) {
    fail_file(file, "is larger than 2 GB");
  }
  if (beginning.empty()) fail_file(file, "is empty");
  const std::string ending = geometry::ending_of(file);
  Opened opened{Format::mesh, {}};
  const bool is_compressed = beginning.starts_with("\x1F\x8B");
  if (is_compressed) opened.bytes = geometry::read_file(file, most_bytes);
  const string_view bytes = is_compressed ? string_view(opened.bytes) : string_view(beginning);
  const std::string text = geometry::as_utf8(std::string(bytes.substr(0, 1 << 16)));
  std::optional<Format> format = format_by_content(text);
  if (!format && geometry::trimmed(text).starts_with('{')) {
    if (!is_compressed) opened.bytes = geometry::read_file(file, most_bytes);
    opened.bytes = geometry::as_utf8(std::move(opened.bytes));
    format = format_of_json(ending, opened.bytes);
  }
  if (!format) format = format_by_ending(ending, role);
  if (!format && text.starts_with("PK\3\4")) {
    fail_file(file, "is a zip archive; unpack it and use the file in it");
  }
  if (!format) {
    fail_file(file,
              "has an unsupported format; supported: CityGML, CityJSON, GeoJSON, GPKG, Shapefile, "
              "KML, KMZ, OSM, DXF, GeoTIFF, ASCII grid, XYZ, LAS, E57, glTF, Collada, FBX, IFC, "
              "PLY, OBJ, STL, OFF, PCD");
  }
  opened.format = *format;
  const bool is_parsed_here = *format == Format::citygml || *format == Format::cityjson;
  if (is_parsed_here) {
    const std::size_t most = *format == Format::citygml ? largest_citygml : largest_cityjson;
    if (opened.bytes.empty()) opened.bytes = geometry::read_file(file, most);
    if (opened.bytes.size() > most) {
      fail_file(file, "is larger than " + std::to_string(most >> 20) + " MiB");
    }
    opened.bytes = geometry::as_utf8(std::move(opened.bytes));
  }
  if (is_compressed && !is_parsed_here && *format != Format::mesh && *format != Format::cloud) {
    fail_file(file, "is gzip-compressed; decompress it first");
  }
  return opened;
}

FileContents mesh_contents(const fs::path& file) {
  FileContents contents;
  contents.format = "mesh" + geometry::ending_of(file);
  contents.is_scene = true;
  FileObject& object = contents.objects.emplace_back();
  object.id = file.stem().string();
  geometry::MeshOptions options;
  options.note = [&](const std::string& note) { contents.notes.push_back(note); };
  object.mesh = geometry::read_mesh(file, options);
  return contents;
}

FileContents cloud_contents(const Source& source) {
  FileContents contents;
  contents.format = "cloud" + geometry::ending_of(source.file);
  contents.is_scene = true;
  CellSet cells;
  const double unit = source.unit.value_or(1.0);
  const double cells_per_unit = unit / source.spacing.value_or(usual_spacing);
  const auto take = [&](std::span<const Eigen::Vector3f> piece, double) {
    for (const Eigen::Vector3f& point : piece) {
      const Eigen::Vector3d place = point.cast<double>();
      if (cells.add(place * cells_per_unit)) contents.points.push_back(place);
    }
  };
  note_skipped(geometry::read_positions(source.file, take), contents);
  return contents;
}

FileContents map_contents(const Source& source) {
  FileContents contents = read_map(source.file, source.select.layer);
  if (contents.format == "DXF") {
    take_dxf_unit(source.file, geometry::read_file(source.file, most_bytes),
                  source.unit.has_value(), contents);
  }
  read_building_heights(contents, source.height_attribute);
  return contents;
}

FileContents scene_contents(const Source& source) {
  const fs::path& file = source.file;
  const std::string ending = geometry::ending_of(file);
  const bool is_gltf =
      ending == ".gltf" || ending == ".glb" || begins_with_one_of(beginning_of(file), {"glTF"});
  // Properties that Assimp ignores are checked before it reads the file.
  SceneFacts facts = is_gltf ? gltf_facts(file, gltf_json(file)) : SceneFacts{};
  FileContents contents = read_scene(file);
  if (ending == ".ifc") {
    facts = ifc_facts(file, geometry::read_file(file, most_bytes), source.unit.has_value());
  }
  if (facts.unit) contents.unit = facts.unit;
  contents.notes.insert(contents.notes.end(), facts.notes.begin(), facts.notes.end());
  contents.format = "scene" + ending;
  return contents;
}

FileContents parsed(Opened opened, const Source& source, const SiteFrame& site) {
  const fs::path& file = source.file;
  const CloudThinning thinning{source.spacing.value_or(usual_spacing),
                               [&](const FileContents& header) {
                                 return SiteTransform(source, header, site).metres_per_unit();
                               }};
  switch (opened.format) {
    case Format::citygml:
      return parse_citygml(file, std::move(opened.bytes));
    case Format::cityjson:
      return parse_cityjson(file, opened.bytes);
    case Format::map:
      return map_contents(source);
    case Format::raster:
      return read_raster(file);
    case Format::las:
      return read_las(file, source.select.classes, thinning);
    case Format::e57:
      return read_e57(file, thinning);
    case Format::scene:
      return scene_contents(source);
    case Format::mesh:
      return mesh_contents(file);
    case Format::cloud:
      break;
  }
  return cloud_contents(source);
}

/// Returns true for formats with objects, not with points or raster nodes.
bool holds_objects(Format format) {
  return format == Format::citygml || format == Format::cityjson || format == Format::map ||
         format == Format::scene || format == Format::mesh;
}

thread_local ReadOnce* read_once = nullptr;

}  // namespace

SharedContents read_contents(const Source& source, const SiteFrame& site) {
  std::error_code ignored;  // The reader reports file errors.
  const std::string key =
      fmt::format("{}\n{}\n{}\n{}", fs::canonical(source.file, ignored).string(),
                  source.select.layer, source.height_attribute, source.unit.has_value());
  if (read_once != nullptr && read_once->contents_ && read_once->key_ == key) {
    return read_once->contents_;
  }
  Opened opened = open_file(source.file, source.role);
  const bool keeps = read_once != nullptr && holds_objects(opened.format);
  // Free the old contents first because two files may exceed the memory.
  if (keeps) read_once->contents_.reset();
  auto contents = std::make_shared<FileContents>(parsed(std::move(opened), source, site));
  if (keeps) {
    read_once->key_ = key;
    read_once->contents_ = contents;
  }
  return contents;
}

ReadOnce::ReadOnce() {
  if (read_once == nullptr) read_once = this;
}

ReadOnce::~ReadOnce() {
  if (read_once == this) read_once = nullptr;
}

}  // namespace skycap::missions::site_data
