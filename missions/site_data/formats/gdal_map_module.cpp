// Maps of polygons by GDAL; geodata_file.cpp loads the module.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "geometry/error.h"
#include "missions/site_data/formats/gdal_dataset.h"
#include "missions/site_data/formats/geodata_file.h"

namespace skycap::missions::site_data {
namespace {

constexpr double storey =
    3.0;  ///< height of a level of a building where only those are counted [m]

/// The number that a text begins with, such as "12.5 m"; none if a unit other than metres follows.
std::optional<double> metres_of(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" +");
  if (begin == std::string::npos) return std::nullopt;
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data() + begin, text.data() + text.size(), number);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
  std::string rest(end, text.data() + text.size());
  std::erase(rest, ' ');
  if (!rest.empty() && rest != "m") return std::nullopt;
  return number;
}

/// OSM's further tags, as GDAL writes them: "key"=>"value","key"=>"value", with \ before quotes.
void add_tags(const std::string& text, std::map<std::string, std::string>& attributes) {
  std::vector<std::string> quoted;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '"') continue;
    std::string& part = quoted.emplace_back();
    for (++i; i < text.size() && text[i] != '"'; ++i) {
      if (text[i] == '\\' && i + 1 < text.size()) ++i;
      part += text[i];
    }
  }
  for (std::size_t i = 0; i + 1 < quoted.size(); i += 2)
    attributes.emplace(quoted[i], quoted[i + 1]);
}

class MapReader {
 public:
  MapReader(const std::filesystem::path& file, GDALDataset& dataset, FileContents& contents)
      : file_(file), dataset_(dataset), contents_(contents) {}

  void read(const std::string& layer);

 private:
  bool is_kml() const { return driver_ == "LIBKML" || driver_ == "KML"; }
  void require_layer(const std::string& layer);
  void take_system(OGRLayer& layer);
  void read_feature(OGRLayer& layer, OGRFeature& feature);
  void read_attributes(OGRFeature& feature, FileObject& object);
  void read_heights(FileObject& object);
  void read_geometry(const OGRGeometry& geometry, FileObject& object);
  void read_polygon(const OGRPolygon& polygon, FileObject& object);
  void read_ring(const OGRSimpleCurve& ring, FilePolygon& polygon);
  void add_notes();

  const std::filesystem::path& file_;
  GDALDataset& dataset_;
  FileContents& contents_;
  std::string driver_;
  bool has_system_ = false;
  std::size_t polygons_ = 0, others_ = 0, by_height_ = 0, by_levels_ = 0;
};

void MapReader::require_layer(const std::string& layer) {
  std::string names;
  for (int i = 0; i < dataset_.GetLayerCount(); ++i) {
    const std::string name = dataset_.GetLayer(i)->GetName();
    if (name == layer) return;
    names += (names.empty() ? "" : ", ") + name;
  }
  throw Error(ErrorKind::bad_config,
              file_.string() + ": has no layer " + layer + "; it has " + names.substr(0, 500));
}

void MapReader::read(const std::string& layer) {
  driver_ = dataset_.GetDriverName();
  contents_.format = driver_;
  contents_.is_outlines = true;
  if (is_kml()) contents_.vertical = HeightDatum::geoid;
  if (driver_ == "GeoJSON") contents_.vertical = HeightDatum::ellipsoid;  // RFC 7946
  if (!layer.empty()) require_layer(layer);
  while (true) {
    OGRLayer* from = nullptr;
    const OGRFeatureUniquePtr feature(dataset_.GetNextFeature(&from, nullptr, nullptr, nullptr));
    if (!feature) break;
    if (from == nullptr || (!layer.empty() && layer != from->GetName())) continue;
    read_feature(*from, *feature);
  }
  if (CPLGetLastErrorType() == CE_Failure)
    fail_file(file_, "is damaged (" + gdal_complaint() + ")");
  add_notes();
}

void MapReader::take_system(OGRLayer& layer) {
  const std::string wkt = wkt_of(layer.GetSpatialRef());
  if (!has_system_) contents_.crs = wkt;
  has_system_ = true;
  if (wkt != contents_.crs) {
    throw Error(ErrorKind::bad_config,
                file_.string() +
                    ": has layers in different reference systems; name one with "
                    "select.layer, such as " +
                    layer.GetName());
  }
}

void MapReader::read_feature(OGRLayer& layer, OGRFeature& feature) {
  const OGRGeometry* const given = feature.GetGeometryRef();
  if (given == nullptr || given->IsEmpty()) return;
  FileObject object;
  object.has_heights = false;
  read_attributes(feature, object);
  object.kind = layer.GetName();
  if (given->hasCurveGeometry() != 0) {
    const std::unique_ptr<OGRGeometry> straight(given->getLinearGeometry());
    if (straight) read_geometry(*straight, object);
  } else {
    read_geometry(*given, object);
  }
  if (object.polygons.empty()) return;
  // Elsewhere a third coordinate is a height; here it counts for nothing without the mode.
  if (is_kml()) {
    const auto mode = object.attributes.find("altitudeMode");
    object.has_heights &= mode != object.attributes.end() && mode->second == "absolute";
  }
  take_system(layer);
  read_heights(object);
  contents_.objects.push_back(std::move(object));
}

void MapReader::read_attributes(OGRFeature& feature, FileObject& object) {
  constexpr std::array<const char*, 8> identifiers = {
      "id", "gml_id", "osm_way_id", "osm_id", "uuid", "identifier", "Name", "EntityHandle"};
  const OGRFeatureDefn& fields = *feature.GetDefnRef();
  for (int i = 0; i < fields.GetFieldCount(); ++i) {
    if (feature.IsFieldSetAndNotNull(i) == 0) continue;
    const std::string name = fields.GetFieldDefn(i)->GetNameRef();
    const std::string value = feature.GetFieldAsString(i);
    if (name == "other_tags") {
      add_tags(value, object.attributes);
    } else {
      object.attributes[name] = value;
    }
  }
  for (const char* identifier : identifiers) {
    const auto found = object.attributes.find(identifier);
    if (found == object.attributes.end() || found->second.empty()) continue;
    object.id = found->second;
    return;
  }
  object.id = std::to_string(feature.GetFID());
}

/// OSM's keys, which others use, too: wiki.openstreetmap.org/wiki/Simple_3D_Buildings.
void MapReader::read_heights(FileObject& object) {
  const auto number = [&](const char* key) -> std::optional<double> {
    const auto found = object.attributes.find(key);
    return found == object.attributes.end() ? std::nullopt : metres_of(found->second);
  };
  object.min_height = number("min_height");
  if (!object.min_height && number("building:min_level")) {
    object.min_height = storey * *number("building:min_level");
  }
  object.height = number("height");
  if (object.height) {
    ++by_height_;
  } else if (const std::optional<double> levels = number("building:levels")) {
    object.height = storey * *levels;
    ++by_levels_;
  }
}

void MapReader::read_geometry(const OGRGeometry& geometry, FileObject& object) {
  switch (wkbFlatten(geometry.getGeometryType())) {
    case wkbPolygon:
    case wkbTriangle:
      return read_polygon(*geometry.toPolygon(), object);
    case wkbMultiPolygon:
    case wkbGeometryCollection:
      for (const OGRGeometry* part : *geometry.toGeometryCollection()) read_geometry(*part, object);
      return;
    case wkbPolyhedralSurface:
    case wkbTIN:
      for (const OGRPolygon* part : *geometry.toPolyhedralSurface()) read_polygon(*part, object);
      return;
    case wkbLineString:
      if (driver_ == "DXF" && geometry.toLineString()->get_IsClosed() != 0) {
        object.has_heights |= geometry.Is3D() != 0;
        read_ring(*geometry.toLineString(), contents_.add_polygon(object));
        return;
      }
      [[fallthrough]];
    default:
      ++others_;
  }
}

void MapReader::read_polygon(const OGRPolygon& polygon, FileObject& object) {
  if (++polygons_ > most_polygons) fail_file(file_, "has more than 50 million polygons");
  object.has_heights |= polygon.Is3D() != 0;
  FilePolygon& result = contents_.add_polygon(object);
  for (const OGRLinearRing* ring : polygon) read_ring(*ring, result);
}

void MapReader::read_ring(const OGRSimpleCurve& ring, FilePolygon& polygon) {
  if (contents_.corners.size() + static_cast<std::size_t>(ring.getNumPoints()) > most_corners) {
    fail_file(file_, "has more than a thousand million corners");
  }
  for (int i = 0; i < ring.getNumPoints(); ++i) {
    const Eigen::Vector3d corner(ring.getX(i), ring.getY(i), ring.getZ(i));
    if (!corner.allFinite()) fail_file(file_, "has a corner that is not finite");
    contents_.corners.push_back(corner);
  }
  contents_.close_ring(polygon);
}

void MapReader::add_notes() {
  if (others_ > 0) {
    contents_.notes.push_back(std::to_string(others_) + " points and lines left out");
  }
  if (by_height_ > 0) {
    contents_.notes.push_back(std::to_string(by_height_) + " outlines have a height of their own");
  }
  if (by_levels_ > 0) {
    contents_.notes.push_back(std::to_string(by_levels_) +
                              " outlines state levels alone: 3 m are taken for each");
  }
}

}  // namespace

extern "C" void skycap_read_map(const std::filesystem::path& file, const std::string& layer,
                                FileContents& contents) {
  const DatasetPtr dataset = open_dataset(
      file, GDAL_OF_VECTOR,
      {"GeoJSON", "GPKG", "ESRI Shapefile", "LIBKML", "KML", "OSM", "DXF", "FlatGeobuf"});
  MapReader(file, *dataset, contents).read(layer);
}

}  // namespace skycap::missions::site_data
