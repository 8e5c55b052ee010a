#include "missions/site_data/prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/pose/prism.h"
#include "missions/site_data/file_reader.h"
#include "missions/site_data/object_builder.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Returns true if the object has no surface at the requested level of detail.
bool is_empty(const Object& object) { return object.mesh.triangles.empty(); }

/// Region of `select.within` in the site frame.
class Region {
 public:
  Region(const Source& source, const SiteFrame& site) {
    if (source.select.within.empty()) return;
    Source polygons;
    polygons.file = source.select.within;
    const SharedContents shared = read_contents(polygons, site);
    const FileContents& contents = *shared;
    const SiteTransform transform(polygons, contents, site, false);
    std::vector<Vector3d> corners = contents.corners;
    transform.to_site(corners);
    for (std::size_t r = 0; r + 1 < contents.ring_begin.size(); ++r) {
      std::vector<Vector2d>& ring = rings_.emplace_back();
      for (std::size_t i = contents.ring_begin[r]; i < contents.ring_begin[r + 1]; ++i) {
        ring.push_back(corners[i].head<2>());
      }
    }
    if (rings_.empty())
      fail_file(polygons.file, "contains no polygons; select.within requires them");
  }

  /// Returns true for all positions if there is no file. Rings within rings are holes.
  bool contains(const Vector2d& pose) const {
    bool is_inside = rings_.empty();
    for (const std::vector<Vector2d>& ring : rings_) {
      if (geometry::contains(ring, pose)) is_inside = !is_inside;
    }
    return is_inside;
  }

 private:
  std::vector<std::vector<Vector2d>> rings_;
};

/// Adds the selected objects. Returns the maximum error of substitute operations in the conversion
/// to WGS84 [m].
double add_objects(const Source& source, const SiteFrame& site, const FileContents& contents,
                   const Region& region, const TerrainHeight& terrain, Prior& prior) {
  ObjectBuilder builder(source, contents, site, terrain);
  std::size_t outside = 0, without_level = 0;
  for (const SelectedObject& selected : select_objects(source, contents)) {
    Object object = builder.build(selected);
    if (is_empty(object)) {
      ++without_level;
    } else if (!region.contains(geometry::bounding_box(object.mesh).center().head<2>())) {
      ++outside;
    } else {
      prior.objects.push_back(std::move(object));
    }
  }
  prior.dropped_polygons = builder.dropped_polygons();
  prior.crs = builder.transform().crs();
  for (const auto& notes : {builder.transform().notes(), builder.notes()}) {
    prior.notes.insert(prior.notes.end(), notes.begin(), notes.end());
  }
  if (outside > 0)
    prior.notes.push_back(std::to_string(outside) + " objects ignored (outside select.within)");
  if (without_level > 0) {
    prior.notes.push_back(std::to_string(without_level) +
                          " objects ignored (no surfaces of this lod)");
  }
  if (builder.has_extruded()) prior.uncertainty = 1.0;
  return builder.transform().substitution_error();
}

void add_points(FileContents& contents, const SiteTransform& transform, const Region& region,
                Prior& prior) {
  transform.to_site(contents.points);
  prior.points.reserve(contents.points.size());
  for (const Vector3d& point : contents.points) {
    if (region.contains(point.head<2>())) prior.points.push_back(point.cast<float>());
  }
}

/// Sets the steps between nodes at the centre of the raster.
void add_steps(const FileContents& contents, const SiteTransform& transform, HeightGrid& grid) {
  const std::size_t middle = contents.rows / 2 * contents.columns + contents.columns / 2;
  const Vector2d here = contents.nodes[middle].head<2>();
  std::array<Vector3d, 3> positions;
  positions.fill(Vector3d::Zero());
  positions[0].head<2>() = here;
  positions[1].head<2>() = here + contents.right;
  positions[2].head<2>() = here + contents.down;
  transform.to_site(positions);
  grid.right = (positions[1] - positions[0]).head<2>().cast<float>();
  grid.down = (positions[2] - positions[0]).head<2>().cast<float>();
}

/// Range of ground heights on the Earth above any datum [m].
constexpr double min_ground_height = -500.0, max_ground_height = 9000.0;

/// Removes impossible heights, which are undeclared nodata values.
void drop_impossible_heights(const Source& source, const SiteTransform& transform,
                             FileContents& contents, Prior& prior) {
  const double unit = transform.metres_per_unit().z();
  std::size_t dropped = 0, kept = 0;
  double first = 0.0;
  for (Vector3d& node : contents.nodes) {
    if (!std::isfinite(node.z())) continue;
    const double height = node.z() * unit;
    if (height >= min_ground_height && height <= max_ground_height) {
      ++kept;
    } else {
      if (dropped++ == 0) first = height;
      node.z() = std::numeric_limits<double>::quiet_NaN();
    }
  }
  if (dropped == 0) return;
  const std::string example = fmt::format("{:.6g} m", first);
  if (kept == 0) {
    throw Error(ErrorKind::bad_config, source.file.string() +
                                           ": heights must be from -500 to 9000 m; one height is " +
                                           example + "; set unit or correct the heights");
  }
  prior.notes.push_back(std::to_string(dropped) +
                        " cells without valid ground height ignored: heights such as " + example +
                        " are outside -500 to 9000 m");
}

void add_grid(FileContents& contents, const SiteTransform& transform, const Region& region,
              Prior& prior) {
  prior.grid.columns = contents.columns;
  prior.grid.rows = contents.rows;
  add_steps(contents, transform, prior.grid);
  const auto none = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  prior.grid.nodes.reserve(contents.nodes.size());
  std::vector<Vector3d> row;
  for (std::size_t first = 0; first < contents.nodes.size(); first += contents.columns) {
    row.clear();
    const std::span nodes = std::span(contents.nodes).subspan(first, contents.columns);
    std::ranges::copy_if(nodes, std::back_inserter(row),
                         [](const Vector3d& node) { return std::isfinite(node.z()); });
    transform.to_site(row);
    auto next = row.begin();
    for (const Vector3d& node : nodes) {
      const bool is_there = std::isfinite(node.z()) && region.contains((*next).head<2>());
      prior.grid.nodes.push_back(is_there ? Eigen::Vector3f(next->cast<float>()) : none);
      if (std::isfinite(node.z())) ++next;
    }
  }
}

/// Calls `visit` with every position of a prior.
template <typename Visit>
void visit_positions(const Prior& prior, const Visit& visit) {
  for (const Object& object : prior.objects) {
    for (const Vector3d& vertex : object.mesh.vertices) visit(vertex);
  }
  for (const Eigen::Vector3f& point : prior.points) visit(point.cast<double>());
  for (const Eigen::Vector3f& node : prior.grid.nodes) {
    if (node.allFinite()) visit(node.cast<double>());
  }
}

/// Computes box and height range. The lowest and highest positions are found on a sphere, which
/// preserves the order of heights that differ by at least one millimetre within a kilometre.
void measure(const SiteFrame& site, Prior& prior) {
  constexpr double earth_radius = 6.371e6;
  double min = std::numeric_limits<double>::infinity(), max = -min;
  Vector3d min_point = Vector3d::Zero(), max_point = min_point;
  visit_positions(prior, [&](const Vector3d& pose) {
    prior.box.extend(pose);
    const double height = pose.z() + pose.head<2>().squaredNorm() / (2.0 * earth_radius);
    if (height < min) min_point = pose;
    if (height > max) max_point = pose;
    min = std::min(min, height);
    max = std::max(max, height);
  });
  if (!site.origin || prior.box.isEmpty()) return;
  const flight::LocalFrame frame(*site.origin);
  const flight::GeodeticPoint low = frame.to_geodetic(min_point),
                              high = frame.to_geodetic(max_point);
  prior.ellipsoid_heights = {low.height, high.height};
  if (!site.undulation) return;
  prior.sea_level_heights = {low.height - *site.undulation, high.height - *site.undulation};
}

/// Warns of an extent that typically indicates a wrong unit or a missing reference system.
void warn_about_size(Prior& prior) {
  constexpr double smallest = 1.0, largest = 5000.0;
  const double size = prior.box.sizes().maxCoeff();
  if (size < smallest) {
    prior.notes.push_back(fmt::format(
        "Warning: the extent of the data is only {:.3g} m. Check unit, crs and place.", size));
  } else if (prior.box.sizes().head<2>().maxCoeff() > largest) {
    prior.notes.push_back(
        fmt::format("Warning: the extent of the data is {:.1f} km. Check unit, crs and place, or "
                    "select a part.",
                    prior.box.sizes().head<2>().maxCoeff() / 1000.0));
  }
}

/// Adds a note with the number of objects without area, which are not obstacles. Throws if all
/// objects are of this kind.
void note_flat_objects(const Source& source, Prior& prior) {
  const auto is_nothing = [](const Object& object) { return !has_area(object.mesh); };
  const auto count = std::ranges::count_if(prior.objects, is_nothing);
  if (count == 0) return;
  if (count == std::ssize(prior.objects) && prior.points.empty() && prior.grid.nodes.empty()) {
    fail_file(source.file, "contains no surface with a positive area");
  }
  prior.notes.push_back(std::to_string(count) + " objects ignored (no surface area)");
}

/// Throws unless the file contains the data that its role requires.
void require_use(const Source& source, const Prior& prior) {
  const auto reject = [&](const std::string& what) {
    throw Error(ErrorKind::bad_config, source.file.string() + ": " + what);
  };
  if (source.role == Role::target && prior.objects.empty()) {
    reject(
        "contains no object surfaces; a target requires them. Reconstruct a mesh (skycap "
        "reconstruct), or use role: obstacle");
  }
  const auto is_surface = [](const Object& object) { return has_area(object.mesh); };
  if (source.role == Role::terrain && prior.points.empty() && prior.grid.nodes.empty() &&
      std::ranges::none_of(prior.objects, is_surface)) {
    reject("contains no surface; terrain requires one. Use role: obstacle");
  }
  if (source.role == Role::terrain && !prior.points.empty()) {
    reject(
        "is a point cloud; terrain must be a raster or a mesh. Rasterise it, or use role: "
        "obstacle");
  }
  if (source.role == Role::truth && !prior.points.empty()) {
    reject("is a point cloud; ground truth must be a raster or a mesh");
  }
}

Prior make_prior(const SharedContents& shared, const Source& source, const SiteFrame& site,
                 const TerrainHeight& terrain) {
  FileContents& contents = *shared;
  reject_unused(source, contents);
  Prior prior;
  prior.role = source.role;
  prior.uncertainty = 0.3;
  prior.format = contents.format;
  prior.notes = contents.notes;
  const Region region(source, site);
  double substitution_error = 0.0;
  if (contents.points.empty() && contents.nodes.empty()) {
    substitution_error = add_objects(source, site, contents, region, terrain, prior);
  } else {
    const SiteTransform transform(source, contents, site);
    drop_impossible_heights(source, transform, contents, prior);
    add_points(contents, transform, region, prior);
    if (!contents.nodes.empty()) add_grid(contents, transform, region, prior);
    substitution_error = transform.substitution_error();
    prior.crs = transform.crs();
    prior.notes.insert(prior.notes.end(), transform.notes().begin(), transform.notes().end());
  }
  prior.uncertainty = source.uncertainty.value_or(prior.uncertainty) + substitution_error;
  measure(site, prior);
  if (prior.box.isEmpty()) {
    fail_file(source.file, "contains neither surfaces nor points that match select");
  }
  note_flat_objects(source, prior);
  require_use(source, prior);
  warn_about_size(prior);
  return prior;
}

/// Returns all selected coordinates of a file.
std::vector<Vector3d> read_positions(const Source& source, const FileContents& contents) {
  std::vector<Vector3d> positions = contents.points;
  positions.insert(positions.end(), contents.nodes.begin(), contents.nodes.end());
  for (const SelectedObject& selected : select_objects(source, contents)) {
    for (const std::size_t member : selected.members) {
      const FileObject& object = contents.objects[member];
      positions.insert(positions.end(), object.mesh.vertices.begin(), object.mesh.vertices.end());
      for (const FilePolygon& polygon : object.polygons) {
        for (std::uint32_t r = polygon.first_ring; r < polygon.first_ring + polygon.rings; ++r) {
          positions.insert(positions.end(), contents.corners.begin() + contents.ring_begin[r],
                           contents.corners.begin() + contents.ring_begin[r + 1]);
        }
      }
    }
  }
  return positions;
}

flight::GeodeticPoint compute_centre(const Source& source, const FileContents& contents) {
  if (contents.crs.empty() && source.crs.empty()) {
    throw Error(ErrorKind::bad_config,
                source.file.string() +
                    ": missing coordinate reference system; set crs, such as \"EPSG:25832+7837\"");
  }
  const SiteTransform transform(source, contents, {}, false);
  std::vector<Vector3d> positions = read_positions(source, contents);
  for (Vector3d& pose : positions) pose.z() = 0.0;
  transform.to_geodetic(positions);
  Eigen::AlignedBox2d box;  // Longitudes are within 180 degrees of the first.
  std::optional<double> first;
  for (const Vector3d& pose : positions) {
    if (!pose.head<2>().allFinite()) continue;
    if (!first) first = pose.x();
    box.extend(Vector2d(*first + std::remainder(pose.x() - *first, 360.0), pose.y()));
  }
  if (box.isEmpty()) fail_file(source.file, "contains no data with a geographic position");
  return {box.center().y(), std::remainder(box.center().x(), 360.0), 0.0};
}

}  // namespace

bool has_area(const geometry::Mesh& mesh) {
  return !mesh.triangles.empty() && geometry::surface_area(mesh) > 0.0;
}

Prior read_prior(const Source& source, const SiteFrame& site, const TerrainHeight& terrain) {
  return make_prior(read_contents(source, site), source, site, terrain);
}

flight::GeodeticPoint compute_centre(const Source& source) {
  return compute_centre(source, *read_contents(source, {}));
}

Source completed(Source source, const Assumptions& assumed) {
  const SharedContents shared = read_contents(source, {});
  const FileContents& contents = *shared;
  if (contents.crs.empty()) source.crs = assumed.crs;
  // The file is in the mission frame.
  if (contents.crs.empty() && source.crs.empty()) return source;
  const bool is_flat = std::ranges::none_of(contents.objects, &FileObject::has_heights);
  if (contents.is_outlines && is_flat && assumed.has_terrain && !source.base) {
    source.base_on_terrain = true;
    return source;
  }
  const SiteTransform transform(source, contents, {}, false);
  std::optional<HeightDatum> vertical = assumed.vertical;
  if (!vertical && assumed.has_heights_above_geoid && !(contents.is_outlines && is_flat)) {
    vertical = HeightDatum::geoid;
  }
  // EGM96 may replace a geoid whose grid is not installed.
  const bool may_substitute = transform.has_vertical_datum() && vertical == HeightDatum::geoid;
  if ((!transform.has_own_heights() || may_substitute) && !contents.vertical) {
    source.vertical = vertical;
  }
  return source;
}

geometry::Mesh read_surfaces(const std::filesystem::path& file) {
  Source source;
  source.file = file;
  source.role = Role::truth;
  SiteFrame site;
  const SharedContents shared = read_contents(source, site);
  const FileContents& contents = *shared;
  if (contents.crs.empty()) {
    source.pose = SourcePose{};
  } else {
    // Substitutes are sufficient because only relative heights matter.
    source.vertical = HeightDatum::geoid;
    site.origin = compute_centre(source, contents);
  }
  const bool is_flat = std::ranges::none_of(contents.objects, &FileObject::has_heights);
  if (contents.is_outlines && is_flat) source.base = 0.0;
  const Prior prior = make_prior(shared, source, site, {});
  geometry::Mesh mesh;
  for (const Object& object : prior.objects) geometry::append(mesh, object.mesh);
  if (mesh.triangles.empty()) fail_file(file, "contains no surfaces; expected a mesh");
  return mesh;
}

}  // namespace skycap::missions::site_data
