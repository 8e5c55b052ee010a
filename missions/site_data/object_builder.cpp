#include "missions/site_data/object_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/error.h"
#include "geometry/surfaces/mesh_repair.h"
#include "geometry/surfaces/polygon_triangulation.h"
#include "missions/site_data/extrusion.h"
#include "missions/site_data/formats/building_heights.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector3d;

/// Returns false for flat outlines on the terrain, which have no heights to transform.
bool needs_heights(const Source& source, const FileContents& contents) {
  return !(contents.is_outlines && source.base_on_terrain);
}

}  // namespace

ObjectBuilder::ObjectBuilder(const Source& source, const FileContents& contents,
                             const SiteFrame& site, const TerrainHeight& terrain)
    : source_(source),
      contents_(contents),
      terrain_(terrain),
      ground_z_(site.ground_z),
      transform_(source, contents, site, needs_heights(source, contents)) {}

Object ObjectBuilder::build(const SelectedObject& selected) {
  const FileObject& named = contents_.objects[selected.object];
  Object result{named.id, named.kind, named.attributes, {}, {}};
  for (const std::size_t member : selected.members) {
    const FileObject& object = contents_.objects[member];
    if (object.reaches_ground && object.has_heights && !source_.base && !source_.base_on_terrain) {
      add_draped(object, result);
    } else if (is_extruded(object)) {
      add_solids(object, result);
    } else {
      add_surfaces(object, result);
    }
    if (object.mesh.triangles.empty()) continue;
    geometry::Mesh mesh = object.mesh;
    transform_.to_site(mesh.vertices);
    geometry::append(result.mesh, mesh);
    result.surfaces.resize(result.mesh.triangles.size(), SurfaceKind::unknown);
  }
  geometry::weld_vertices(result.mesh);
  return result;
}

ObjectBuilder::Rings ObjectBuilder::make_rings(const FileObject& object) const {
  Rings rings;
  for (const FilePolygon& polygon : select_polygons(object, source_.select.lod)) {
    rings.first_ring.push_back(rings.begin.size() - 1);
    rings.kinds.push_back(polygon.kind);
    for (std::uint32_t r = polygon.first_ring; r < polygon.first_ring + polygon.rings; ++r) {
      const auto corners = contents_.corners.begin();
      rings.corners.insert(rings.corners.end(), corners + contents_.ring_begin[r],
                           corners + contents_.ring_begin[r + 1]);
      rings.begin.push_back(static_cast<std::uint32_t>(rings.corners.size()));
    }
  }
  rings.first_ring.push_back(rings.begin.size() - 1);
  return rings;
}

/// Returns false for polygons with their own heights, which are surfaces, unless they are placed on
/// the terrain or have a height attribute.
bool ObjectBuilder::is_extruded(const FileObject& object) const {
  const bool is_placed = source_.base_on_terrain || source_.height || object.height;
  return contents_.is_outlines && !object.polygons.empty() && (!object.has_heights || is_placed);
}

void ObjectBuilder::add_surfaces(const FileObject& object, Object& result) {
  Rings rings = make_rings(object);
  transform_.to_site(rings.corners);
  for (std::size_t i = 0; i < rings.kinds.size(); ++i) {
    const auto begin =
        std::span(rings.begin)
            .subspan(rings.first_ring[i], rings.first_ring[i + 1] - rings.first_ring[i] + 1);
    if (geometry::add_polygon(result.mesh, rings.corners, begin) == 0) ++dropped_;
    result.surfaces.resize(result.mesh.triangles.size(), rings.kinds[i]);
  }
}

/// Returns the height of an outline's solid above its base [m].
double ObjectBuilder::compute_height(const FileObject& object) const {
  const std::string name = source_.file.string() + ": ";
  // Another height could be lower than the actual one.
  if (!object.height_problem.empty()) {
    throw Error(ErrorKind::bad_config, name + one_line(object.id) + " " +
                                           one_line(object.height_problem) +
                                           "; correct it or exclude the object with select");
  }
  std::optional<double> height = source_.height ? source_.height : object.height;
  // Obstacles get the maximum of all stated heights.
  if (source_.role == Role::obstacle && object.height) {
    height = std::max(*height, *object.height);
  }
  if (!height) {
    throw Error(ErrorKind::bad_config, name + "contains no height of " + one_line(object.id) +
                                           "; set height to the height above its base in metres, "
                                           "or set height_attribute (available attributes: " +
                                           attribute_names(object) + ")");
  }
  return *height;
}

void ObjectBuilder::add_solids(const FileObject& object, Object& result) {
  const double height = compute_height(object);
  const double min =
      source_.min_height > 0.0 ? source_.min_height : object.min_height.value_or(0.0);
  if (!(height > min)) {
    throw Error(ErrorKind::bad_config, source_.file.string() + ": the height of " +
                                           one_line(object.id) + ", " + std::to_string(height) +
                                           " m, must be greater than that of its base, " +
                                           std::to_string(min) + " m");
  }
  has_extruded_ = true;
  Rings bottom = make_rings(object), top = bottom;
  if (source_.base_on_terrain) {
    place_on_terrain(bottom, top, min, height);
  } else {
    place_on_base(object.has_heights, bottom, top, min, height);
  }
  add_columns(bottom, top, result);
}

/// Adds the solid between a polygon with heights (top) and the ground. Where the terrain is
/// unknown, it extends below the assumed ground plane. For obstacles, the depth exceeds that of any
/// slope.
void ObjectBuilder::add_draped(const FileObject& object, Object& result) {
  constexpr double below_plane = 100.0;  // [m]
  has_extruded_ = true;
  Rings top = make_rings(object);
  transform_.to_site(top.corners);
  for (Vector3d& corner : top.corners) corner.z() += source_.height.value_or(0.0);
  double ground = ground_below(top.corners);
  if (!std::isfinite(ground)) {
    double min_height = ground_z_;
    for (const Vector3d& corner : top.corners) min_height = std::min(min_height, corner.z());
    const bool is_obstacle = source_.role == Role::obstacle;
    ground = min_height - (is_obstacle ? below_plane : 0.0);
    if (notes_.empty()) {
      notes_.emplace_back(
          is_obstacle
              ? "unknown terrain below some polygons: they extend 100 m below the assumed ground "
                "plane"
              : "unknown terrain below some polygons: they extend to the assumed ground plane");
    }
  }
  Rings bottom = top;
  for (Vector3d& corner : bottom.corners) corner.z() = std::min(corner.z(), ground);
  add_columns(bottom, top, result);
}

/// Returns the minimum ground height below the corners; infinite where it is unknown.
double ObjectBuilder::ground_below(std::span<const Vector3d> corners) const {
  double min_height = std::numeric_limits<double>::infinity();
  for (const Vector3d& corner : corners) {
    const std::optional<double> ground = terrain_ ? terrain_(corner.head<2>()) : std::nullopt;
    if (ground) min_height = std::min(min_height, *ground);
  }
  return min_height;
}

void ObjectBuilder::add_columns(const Rings& bottom, const Rings& top, Object& result) {
  for (std::size_t i = 0; i < bottom.kinds.size(); ++i) {
    const std::size_t first = bottom.first_ring[i], end = bottom.first_ring[i + 1];
    const std::uint32_t shift = bottom.begin[first];
    std::vector<std::uint32_t> begin(bottom.begin.begin() + static_cast<std::ptrdiff_t>(first),
                                     bottom.begin.begin() + static_cast<std::ptrdiff_t>(end) + 1);
    for (std::uint32_t& corner_index : begin) corner_index -= shift;
    const auto part = [&](const Rings& rings) {
      return std::span(rings.corners).subspan(shift, begin.back());
    };
    if (!add_extruded(result, part(bottom), part(top), begin)) ++dropped_;
  }
}

void ObjectBuilder::place_on_base(bool has_heights, Rings& bottom, Rings& top, double min,
                                  double max) const {
  const double unit = transform_.metres_per_unit().z();
  double base = std::numeric_limits<double>::infinity();  // In the file's units.
  if (source_.base) {
    base = *source_.base / unit;
  } else if (has_heights) {
    for (const Vector3d& corner : bottom.corners) base = std::min(base, corner.z());
  } else {
    throw Error(ErrorKind::bad_config,
                source_.file.string() +
                    ": the outlines have no base height; set base to a height or to terrain");
  }
  for (Vector3d& corner : bottom.corners) corner.z() = base + min / unit;
  for (Vector3d& corner : top.corners) corner.z() = base + max / unit;
  transform_.to_site(bottom.corners);
  transform_.to_site(top.corners);
}

void ObjectBuilder::place_on_terrain(Rings& bottom, Rings& top, double min, double max) const {
  if (!terrain_) {
    throw Error(ErrorKind::bad_config,
                source_.file.string() + ": base: terrain requires prior data with role: terrain");
  }
  transform_.to_site(bottom.corners);
  const double base = ground_below(bottom.corners);
  if (!std::isfinite(base)) {
    throw Error(ErrorKind::bad_config,
                source_.file.string() + ": an outline is located on unknown terrain");
  }
  top.corners = bottom.corners;
  for (Vector3d& corner : bottom.corners) corner.z() = base + min;
  for (Vector3d& corner : top.corners) corner.z() = base + max;
}

}  // namespace skycap::missions::site_data
