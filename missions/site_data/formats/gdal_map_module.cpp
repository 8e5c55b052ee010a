// Reader of map polygons based on GDAL. geodata_file.cpp loads this module.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "geometry/error.h"
#include "missions/site_data/formats/gdal_dataset.h"
#include "missions/site_data/formats/geodata_file.h"
#include "missions/site_data/formats/map_tags.h"

namespace skycap::missions::site_data {
namespace {

/// Half the width of the outlines around points and lines that have a height [m].
constexpr double pole_radius = 0.5, wall_radius = 0.25;

class MapReader {
 public:
  MapReader(const std::filesystem::path& file, GDALDataset& dataset, FileContents& contents)
      : file_(file), dataset_(dataset), contents_(contents) {}

  void read(const std::string& layer);

 private:
  bool is_kml() const { return driver_ == "LIBKML" || driver_ == "KML"; }
  void require_layer(const std::string& layer);
  void read_reference_system(OGRLayer& layer);
  void set_units(OGRLayer& layer, double latitude);
  void read_feature(OGRLayer& layer, OGRFeature& feature);
  void read_attributes(OGRFeature& feature, FileObject& object);
  void read_altitudes(FileObject& object, double max_height);
  void read_geometry(const OGRGeometry& geometry, FileObject& object);
  void read_polygon(const OGRPolygon& polygon, FileObject& object);
  void read_ring(const OGRSimpleCurve& ring, FilePolygon& polygon);
  void read_line(const OGRLineString& line, FileObject& object);
  void add_pole(const OGRPoint& point, FileObject& object);
  void add_wall(const OGRLineString& line, FileObject& object);
  void add_corner(double x, double y, double z);
  void leave_out(const FileObject& object);
  void add_notes();

  const std::filesystem::path& file_;
  GDALDataset& dataset_;
  FileContents& contents_;
  std::string driver_;
  std::set<std::string> names_;  ///< Values of `name` that identify an object.
  bool has_system_ = false;
  /// Units of the layer per metre at the feature.
  Eigen::Vector2d units_per_metre_ = Eigen::Vector2d::Ones();
  std::size_t polygons_ = 0, others_ = 0, cables_ = 0, no_structures_ = 0, without_geometry_ = 0,
              thin_ = 0, raised_ = 0, extruded_ = 0;
};

void MapReader::require_layer(const std::string& layer) {
  std::string names;
  for (int i = 0; i < dataset_.GetLayerCount(); ++i) {
    const std::string name = dataset_.GetLayer(i)->GetName();
    if (name == layer) return;
    names += (names.empty() ? "" : ", ") + name;
  }
  throw Error(ErrorKind::bad_config, file_.string() + ": unknown layer " + layer +
                                         "; expected one of: " + names.substr(0, 500));
}

void MapReader::read(const std::string& layer) {
  driver_ = dataset_.GetDriverName();
  contents_.format = driver_;
  contents_.is_outlines = true;
  contents_.is_map = driver_ != "DXF";  // Drawings use a linear unit.
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
    fail_file(file_, "is damaged (" + last_gdal_error() + ")");
  add_notes();
}

void MapReader::read_reference_system(OGRLayer& layer) {
  std::string wkt = to_wkt(layer.GetSpatialRef());
  // GeoPackages contain placeholder names for undefined systems.
  if (wkt.find("\"Undefined ") != std::string::npos) wkt.clear();
  if (!has_system_) contents_.crs = wkt;
  has_system_ = true;
  if (wkt != contents_.crs) {
    throw Error(
        ErrorKind::bad_config,
        file_.string() +
            ": has layers in different reference systems; choose one with select.layer, such as " +
            layer.GetName());
  }
}

/// Sets the number of the layer's units per metre.
void MapReader::set_units(OGRLayer& layer, double latitude) {
  const OGRSpatialReference* const system = layer.GetSpatialRef();
  if (system == nullptr) {
    units_per_metre_.setOnes();
  } else if (system->IsGeographic() != 0) {
    constexpr double degrees_per_metre = 1.0 / 111'320.0, radian = M_PI / 180.0;
    const double narrow = std::max(0.01, std::cos(latitude * radian));
    units_per_metre_ = {degrees_per_metre / narrow, degrees_per_metre};
  } else {
    units_per_metre_.setConstant(1.0 / system->GetLinearUnits());
  }
}

void MapReader::read_feature(OGRLayer& layer, OGRFeature& feature) {
  const OGRGeometry* const given = feature.GetGeometryRef();
  if (given == nullptr || given->IsEmpty()) {
    ++without_geometry_;
    return;
  }
  FileObject object;
  object.has_heights = false;
  read_attributes(feature, object);
  object.kind = layer.GetName();
  OGREnvelope envelope;
  given->getEnvelope(&envelope);
  set_units(layer, 0.5 * (envelope.MinY + envelope.MaxY));
  const std::size_t first_corner = contents_.corners.size();
  if (given->hasCurveGeometry() != 0) {
    const std::unique_ptr<OGRGeometry> straight(given->getLinearGeometry());
    if (straight) read_geometry(*straight, object);
  } else {
    read_geometry(*given, object);
  }
  if (object.polygons.empty()) return;
  if (driver_ == "OSM" && !is_structure(object)) {
    ++no_structures_;
    return;
  }
  if (is_kml()) {
    double max_height = 0.0;
    for (std::size_t i = first_corner; i < contents_.corners.size(); ++i) {
      max_height = std::max(max_height, contents_.corners[i].z());
    }
    read_altitudes(object, max_height);
  }
  read_reference_system(layer);
  contents_.objects.push_back(std::move(object));
}

/// Interprets the third coordinate. In KML, the altitude mode defines its meaning; in other formats
/// it is a height. `max_height` is the maximum of the corners.
void MapReader::read_altitudes(FileObject& object, double max_height) {
  const auto mode = object.attributes.find("altitudeMode");
  const std::string name = mode == object.attributes.end() ? "" : mode->second;
  const bool is_extruded = numeric_tag(object, "extrude") != 0.0;
  const bool has_corners = object.has_heights;
  object.has_heights = has_corners && name == "absolute";
  if (object.has_heights && is_extruded) {
    object.reaches_ground = true;
    ++extruded_;
  }
  // On land, the sea floor is the ground.
  const bool is_relative = name == "relativeToGround" || name == "relativeToSeaFloor";
  if (has_corners && is_relative && max_height > 0.0) {
    object.height = max_height;
    if (!is_extruded) ++raised_;
  }
}

void MapReader::read_attributes(OGRFeature& feature, FileObject& object) {
  // GDAL calls the KML element `Name`; Overpass writes `@id`; GeoJSON often has only `name`.
  constexpr std::array<const char*, 10> identifiers = {
      "id",   "gml_id",     "osm_way_id", "osm_id",       "@id",
      "uuid", "identifier", "Name",       "EntityHandle", "name"};
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
    // Values of `name` can repeat. Later objects with the same name get their numbers.
    if (identifier == identifiers.back() && !names_.insert(found->second).second) break;
    object.id = found->second;
    return;
  }
  object.id = std::to_string(feature.GetFID());
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
      return read_line(*geometry.toLineString(), object);
    case wkbMultiLineString:
    case wkbMultiPoint:
      for (const OGRGeometry* part : *geometry.toGeometryCollection()) read_geometry(*part, object);
      return;
    case wkbPoint:
      if (may_state_height(object) || numeric_tag(object, "extrude") != 0.0) {
        return add_pole(*geometry.toPoint(), object);
      }
      [[fallthrough]];
    default:
      leave_out(object);
  }
}

/// Reads a line. Closed lines are polygons in drawings, and in OpenStreetMap if they are parts of
/// buildings or other structures. Lines with a height are walls.
void MapReader::read_line(const OGRLineString& line, FileObject& object) {
  const bool is_closed = line.get_IsClosed() != 0 && line.getNumPoints() > 3;
  const bool is_part =
      driver_ == "OSM" && (has_tag(object, "building:part") || has_tag(object, "building") ||
                           has_tag(object, "man_made"));
  if (is_closed && (driver_ == "DXF" || is_part)) {
    object.has_heights |= line.Is3D() != 0;
    if (++polygons_ > max_polygons) fail_file(file_, "has more than 50 million polygons");
    read_ring(line, contents_.add_polygon(object));
  } else if (may_state_height(object) || numeric_tag(object, "extrude") != 0.0) {
    add_wall(line, object);
  } else {
    leave_out(object);
  }
}

void MapReader::leave_out(const FileObject& object) { ++(is_cable(object) ? cables_ : others_); }

void MapReader::add_corner(double x, double y, double z) {
  const Eigen::Vector3d corner(x, y, z);
  if (!corner.allFinite()) fail_file(file_, "has a corner with a non-finite coordinate");
  if (contents_.corners.size() == max_corners) {
    fail_file(file_, "has more than 1 billion corners");
  }
  contents_.corners.push_back(corner);
}

/// Adds an octagon around a point with the width of the object's attributes.
void MapReader::add_pole(const OGRPoint& point, FileObject& object) {
  object.is_thin = true;
  object.has_heights |= point.Is3D() != 0;
  double radius = pole_radius;
  for (const char* key : {"diameter", "diameter_crown", "width"}) {
    radius = std::max(radius, 0.5 * std::min(100.0, numeric_tag(object, key)));
  }
  radius /= std::cos(M_PI / 8.0);
  FilePolygon& polygon = contents_.add_polygon(object);
  for (int i = 0; i < 8; ++i) {
    const double angle = i * M_PI / 4.0;
    add_corner(point.getX() + radius * units_per_metre_.x() * std::cos(angle),
               point.getY() + radius * units_per_metre_.y() * std::sin(angle), point.getZ());
  }
  contents_.close_ring(polygon);
  ++thin_;
}

/// Adds a rectangle around each segment.
void MapReader::add_wall(const OGRLineString& line, FileObject& object) {
  object.is_thin = true;
  object.has_heights |= line.Is3D() != 0;
  for (int i = 0; i + 1 < line.getNumPoints(); ++i) {
    const Eigen::Vector2d from(line.getX(i), line.getY(i)), to(line.getX(i + 1), line.getY(i + 1));
    const Eigen::Vector2d metres = (to - from).cwiseQuotient(units_per_metre_);
    if (!(metres.norm() > 0.0)) continue;
    const Eigen::Vector2d along = metres.normalized() * wall_radius, across(-along.y(), along.x());
    if (++polygons_ > max_polygons) fail_file(file_, "has more than 50 million polygons");
    FilePolygon& polygon = contents_.add_polygon(object);
    const auto add = [&](const Eigen::Vector2d& position, const Eigen::Vector2d& neighbour,
                         double z) {
      const Eigen::Vector2d corner = position + neighbour.cwiseProduct(units_per_metre_);
      add_corner(corner.x(), corner.y(), z);
    };
    add(from, -along - across, line.getZ(i));
    add(to, along - across, line.getZ(i + 1));
    add(to, along + across, line.getZ(i + 1));
    add(from, across - along, line.getZ(i));
    contents_.close_ring(polygon);
  }
  ++thin_;
}

void MapReader::read_polygon(const OGRPolygon& polygon, FileObject& object) {
  if (++polygons_ > max_polygons) fail_file(file_, "has more than 50 million polygons");
  object.has_heights |= polygon.Is3D() != 0;
  FilePolygon& result = contents_.add_polygon(object);
  for (const OGRLinearRing* ring : polygon) read_ring(*ring, result);
}

void MapReader::read_ring(const OGRSimpleCurve& ring, FilePolygon& polygon) {
  for (int i = 0; i < ring.getNumPoints(); ++i) {
    add_corner(ring.getX(i), ring.getY(i), ring.getZ(i));
  }
  contents_.close_ring(polygon);
}

void MapReader::add_notes() {
  std::vector<std::string> left_out;
  const auto add = [&](std::size_t count, const char* what, std::vector<std::string>& notes) {
    if (count > 0) notes.push_back(std::to_string(count) + what);
  };
  add(others_, " points and lines ignored", left_out);
  add(cables_, " power lines and cableways ignored (no height)", left_out);
  add(no_structures_, " areas ignored (neither buildings nor other structures)", left_out);
  add(without_geometry_, " objects ignored (empty or unsupported geometry)", left_out);
  if (contents_.objects.empty() && !left_out.empty()) {
    std::string all;
    for (const std::string& note : left_out) all += (all.empty() ? "" : ", ") + note;
    fail_file(file_, "contains no outlines and no other objects with a height (" + all + ")");
  }
  contents_.notes.insert(contents_.notes.end(), left_out.begin(), left_out.end());
  add(thin_,
      " points and lines with a height are read as poles (at least 1 m wide) and walls (0.5 m "
      "thick)",
      contents_.notes);
  add(extruded_, " polygons with the attribute extrude extend from their altitude to the ground",
      contents_.notes);
  add(raised_,
      " polygons above the ground without the attribute extrude are assumed to stand on the ground",
      contents_.notes);
}

}  // namespace

extern "C" void skycap_read_map(const std::filesystem::path& file, const std::string& layer,
                                FileContents& contents) {
  const OpenDataset dataset(
      file, GDAL_OF_VECTOR,
      {"GeoJSON", "GPKG", "ESRI Shapefile", "LIBKML", "KML", "OSM", "DXF", "FlatGeobuf"});
  contents.notes = dataset.notes();
  MapReader(file, *dataset, contents).read(layer);
}

}  // namespace skycap::missions::site_data
