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
#include "missions/site_data/formats/photogrammetry_offset.h"
#include "missions/site_data/formats/scene_facts.h"
#include "missions/site_data/site_transform.h"

namespace skycap::missions::site_data {
namespace {

using std::string_view;
namespace fs = std::filesystem;

enum class Format { citygml, cityjson, map, raster, las, e57, scene, mesh, cloud };

bool is_one_of(string_view text, std::initializer_list<string_view> candidates) {
  return std::ranges::find(candidates, text) != candidates.end();
}

bool starts_with_any(string_view text, std::initializer_list<string_view> candidates) {
  return std::ranges::any_of(candidates,
                             [&](string_view begin) { return text.starts_with(begin); });
}

/// Returns the local name of the root element; empty if the text is not XML.
string_view find_root_element(string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == string_view::npos || text[first] != '<') return {};
  std::size_t offset = first;
  while (offset + 1 < text.size() && (text[offset + 1] == '?' || text[offset + 1] == '!')) {
    const bool is_comment = text.substr(offset).starts_with("<!--");
    offset = text.find(is_comment ? "-->" : ">", offset);
    if (offset != string_view::npos) offset = text.find('<', offset);
    if (offset == string_view::npos) return {};
  }
  const std::size_t end = std::min(text.find_first_of(" \t\r\n/>", offset + 1), text.size());
  string_view name = text.substr(offset + 1, end - offset - 1);
  return name.substr(name.rfind(':') + 1);
}

std::optional<Format> detect_xml_format(string_view root, string_view text) {
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
  return starts_with_any(text, {"ncols", "nrows", "xllcorner", "yllcorner", "xllcenter",
                                "yllcenter", "cellsize", "dx ", "dy "});
}

std::optional<Format> format_by_content(string_view beginning) {
  using namespace std::string_view_literals;
  if (beginning.starts_with("LASF")) return Format::las;
  if (beginning.starts_with("ASTM-E57")) return Format::e57;
  if (starts_with_any(beginning, {"glTF", "Kaydara FBX", "; FBX"}) ||
      geometry::trimmed(beginning).starts_with("ISO-10303-21")) {
    return Format::scene;
  }
  if (starts_with_any(beginning, {"SQLite format 3", "\0\0\x27\x0A"sv, "fgb\3fgb"})) {
    return Format::map;
  }
  if (starts_with_any(beginning, {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv, "\0\0\0\x0CjP"sv}) ||
      is_ascii_grid(beginning)) {
    return Format::raster;
  }
  if (starts_with_any(beginning, {"ply\n", "ply\r"})) {
    const bool has_faces = beginning.find("element face") != string_view::npos ||
                           beginning.find("element tristrips") != string_view::npos;
    return has_faces ? Format::mesh : Format::cloud;
  }
  if (starts_with_any(beginning, {"# .PCD", "VERSION"})) return Format::cloud;
  if (starts_with_any(beginning, {"OFF", "DRACO"})) return Format::mesh;
  return detect_xml_format(find_root_element(beginning), beginning);
}

std::optional<Format> format_by_extension(const std::string& extension, Role role) {
  if (is_one_of(extension, {".obj", ".off", ".stl", ".drc", ".ply"})) return Format::mesh;
  if (is_one_of(extension, {".pcd", ".txt", ".asc", ".pts", ".csv"})) return Format::cloud;
  if (is_one_of(extension, {".dae", ".fbx", ".3ds", ".ifc", ".gltf", ".glb"})) return Format::scene;
  if (is_one_of(extension, {".dxf", ".pbf", ".shp", ".geojson", ".fgb", ".gpkg", ".kmz"})) {
    return Format::map;
  }
  if (is_one_of(extension, {".tif", ".tiff", ".jp2"})) return Format::raster;
  // Terrain is commonly distributed as gridded lines of x y z.
  if (extension == ".xyz") return role == Role::terrain ? Format::raster : Format::cloud;
  return std::nullopt;
}

/// Returns the position after the closing quote of the JSON string that starts at `quote`.
std::size_t find_string_end(string_view text, std::size_t quote) {
  std::size_t offset = quote + 1;
  while (offset < text.size() && text[offset] != '"') offset += text[offset] == '\\' ? 2 : 1;
  return std::min(offset + 1, text.size());
}

/// Type information in the outermost object of a JSON text.
struct JsonKind {
  string_view type;        ///< Value of the key "type".
  bool has_asset = false;  ///< Has the key "asset", which glTF requires.
};

JsonKind detect_json_kind(string_view text) {
  JsonKind kind;
  int depth = 0;
  string_view key;  // Key of the next value.
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    if (depth == 0 && c == '}') break;
    if (c == ',' && depth == 1) key = {};
    if (c != '"') continue;
    const std::size_t end = find_string_end(text, i);
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

Format detect_json_format(const std::string& extension, string_view text) {
  const JsonKind kind = detect_json_kind(text);
  if (is_one_of(kind.type, {"CityJSON", "CityJSONFeature"})) return Format::cityjson;
  const bool is_gltf = extension == ".gltf" || (kind.has_asset && kind.type.empty());
  return is_gltf ? Format::scene : Format::map;
}

std::string read_head(const fs::path& file) {
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
    fail_file(file, "does not exist or is not a regular file");
  const std::string beginning = read_head(file);
  const bool is_streamed = starts_with_any(beginning, {"LASF", "ASTM-E57"});
  if (!is_streamed && fs::file_size(file, failure) > max_bytes) {
    fail_file(file, "is larger than 2 GB");
  }
  if (beginning.empty()) fail_file(file, "is empty");
  const std::string extension = geometry::lower_extension(file);
  Opened opened{Format::mesh, {}};
  const bool is_compressed = beginning.starts_with("\x1F\x8B");
  if (is_compressed) opened.bytes = geometry::read_file(file, max_bytes);
  const string_view bytes = is_compressed ? string_view(opened.bytes) : string_view(beginning);
  const std::string text = geometry::as_utf8(std::string(bytes.substr(0, 1 << 16)));
  std::optional<Format> format = format_by_content(text);
  if (!format && geometry::trimmed(text).starts_with('{')) {
    if (!is_compressed) opened.bytes = geometry::read_file(file, max_bytes);
    opened.bytes = geometry::as_utf8(std::move(opened.bytes));
    format = detect_json_format(extension, opened.bytes);
  }
  if (!format) format = format_by_extension(extension, role);
  if (!format && text.starts_with("PK\3\4")) {
    fail_file(file, "is a zip archive; unpack it and use the file in it");
  }
  if (!format) {
    fail_file(file,
              "has an unsupported format; supported formats: CityGML, CityJSON, GeoJSON, GPKG, "
              "Shapefile, "
              "KML, KMZ, OSM, DXF, GeoTIFF, ASCII grid, XYZ, LAS, E57, glTF, Collada, FBX, IFC, "
              "PLY, OBJ, STL, OFF, PCD");
  }
  opened.format = *format;
  const bool is_parsed_here = *format == Format::citygml || *format == Format::cityjson;
  if (is_parsed_here) {
    const std::size_t max = *format == Format::citygml ? largest_citygml : largest_cityjson;
    if (opened.bytes.empty()) opened.bytes = geometry::read_file(file, max);
    if (opened.bytes.size() > max) {
      fail_file(file, "is larger than " + std::to_string(max >> 20) + " MiB");
    }
    opened.bytes = geometry::as_utf8(std::move(opened.bytes));
  }
  if (is_compressed && !is_parsed_here && *format != Format::mesh && *format != Format::cloud) {
    fail_file(file, "is gzip-compressed; decompress it first");
  }
  return opened;
}

/// Moves a mesh of a photogrammetry program to map coordinates, unless the source states its
/// position.
void apply_photogrammetry_offset(const Source& source, FileContents& contents) {
  if (source.pose || !source.offset.isZero()) return;
  const auto found = find_photogrammetry_offset(source.file);
  if (!found) return;
  const std::string name = found->file.filename().string();
  if (found->crs.empty() && source.crs.empty()) {
    throw Error(ErrorKind::bad_config,
                source.file.string() + ": has the coordinate offset of " + name +
                    " but no coordinate reference system; set crs to that of the photogrammetry "
                    "project, or set offset: [0, 0, 0] and place");
  }
  for (Eigen::Vector3d& vertex : contents.objects.front().mesh.vertices) vertex += found->offset;
  if (source.crs.empty()) {
    contents.crs = found->crs;
    contents.vertical = HeightDatum::ellipsoid;
  }
  contents.notes.push_back(fmt::format(
      "coordinate offset ({:.3f}, {:.3f}, {:.3f}) read from {}{}", found->offset.x(),
      found->offset.y(), found->offset.z(), name,
      source.crs.empty()
          ? ", in " + found->crs + "; ellipsoidal heights are assumed unless vertical is set"
          : ""));
}

FileContents mesh_contents(const Source& source) {
  const fs::path& file = source.file;
  FileContents contents;
  contents.format = "mesh" + geometry::lower_extension(file);
  contents.is_scene = true;
  FileObject& object = contents.objects.emplace_back();
  object.id = file.stem().string();
  geometry::MeshOptions options;
  options.note = [&](const std::string& note) { contents.notes.push_back(note); };
  object.mesh = geometry::read_mesh(file, options);
  apply_photogrammetry_offset(source, contents);
  return contents;
}

FileContents cloud_contents(const Source& source) {
  FileContents contents;
  contents.format = "cloud" + geometry::lower_extension(source.file);
  contents.is_scene = true;
  CellSet cells;
  const double unit = source.unit.value_or(1.0);
  const double cells_per_unit = unit / source.spacing.value_or(usual_spacing);
  const auto callback = [&](std::span<const Eigen::Vector3f> chunk, double) {
    for (const Eigen::Vector3f& point : chunk) {
      const Eigen::Vector3d offset = point.cast<double>();
      if (cells.add(offset * cells_per_unit)) contents.points.push_back(offset);
    }
  };
  note_skipped(geometry::read_positions(source.file, callback), contents);
  return contents;
}

FileContents map_contents(const Source& source) {
  FileContents contents = read_map(source.file, source.select.layer);
  if (contents.format == "DXF") {
    apply_dxf_unit(source.file, geometry::read_file(source.file, max_bytes),
                   source.unit.has_value(), contents);
  }
  read_building_heights(contents, source.height_attribute);
  return contents;
}

FileContents scene_contents(const Source& source) {
  const fs::path& file = source.file;
  const std::string extension = geometry::lower_extension(file);
  const bool is_gltf =
      extension == ".gltf" || extension == ".glb" || starts_with_any(read_head(file), {"glTF"});
  // Properties that Assimp ignores are checked before it reads the file.
  SceneFacts facts = is_gltf ? gltf_facts(file, gltf_json(file)) : SceneFacts{};
  FileContents contents = read_scene(file);
  if (extension == ".ifc") {
    facts = ifc_facts(file, geometry::read_file(file, max_bytes), source.unit.has_value());
  }
  if (facts.unit) contents.unit = facts.unit;
  contents.notes.insert(contents.notes.end(), facts.notes.begin(), facts.notes.end());
  contents.format = "scene" + extension;
  return contents;
}

FileContents parsed(Opened opened, const Source& source, const SiteFrame& site) {
  const fs::path& file = source.file;
  const CloudDownsampling downsampling{
      source.spacing.value_or(usual_spacing), [&](const FileContents& header) {
        // A missing vertical datum is reported later, when it may have been set.
        return SiteTransform(source, header, site, false).metres_per_unit();
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
      return read_las(file, source.select.classes, downsampling);
    case Format::e57:
      return read_e57(file, downsampling);
    case Format::scene:
      return scene_contents(source);
    case Format::mesh:
      return mesh_contents(source);
    case Format::cloud:
      break;
  }
  return cloud_contents(source);
}

/// Returns true for formats with objects, not with points or raster nodes.
bool supports_objects(Format format) {
  return format == Format::citygml || format == Format::cityjson || format == Format::map ||
         format == Format::scene || format == Format::mesh;
}

thread_local ReadOnce* read_once = nullptr;

}  // namespace

SharedContents read_contents(const Source& source, const SiteFrame& site) {
  std::error_code ignored;  // The reader reports file errors.
  const std::string key =
      fmt::format("{}\n{}\n{}\n{}\n{}\n{}", fs::canonical(source.file, ignored).string(),
                  source.select.layer, source.height_attribute, source.unit.has_value(),
                  source.pose || !source.offset.isZero(), source.crs);
  if (read_once != nullptr && read_once->contents_ && read_once->key_ == key) {
    return read_once->contents_;
  }
  Opened opened = open_file(source.file, source.role);
  const bool keeps = read_once != nullptr && supports_objects(opened.format);
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
