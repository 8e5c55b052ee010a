/// Output of the readers of prior data: the contents of a file in its own coordinates, before
/// selection, transformation and triangulation. prior.cpp converts it to a Prior.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"
#include "missions/site_data/formats/meanings.h"

namespace skycap::missions::site_data {

/// Polygon of consecutive rings: the outline, then its holes.
struct FilePolygon {
  std::uint32_t first_ring = 0, rings = 0;
  SurfaceKind kind = SurfaceKind::unknown;
  std::optional<double> lod;  ///< Level of detail; empty for polygons that belong to all levels.
};

struct FileObject {
  std::string id;
  std::optional<std::size_t> parent;  ///< Index of the parent object, which precedes this object.
  std::string kind;
  std::map<std::string, std::string> attributes;
  std::vector<FilePolygon> polygons;
  bool has_heights = true;  ///< The z coordinates of the polygons are defined.
  geometry::Mesh mesh;      ///< Mesh of formats with triangles.
  /// Heights of the extruded outline [m]. Empty if the polygons are surfaces or the source must
  /// define the height.
  std::optional<double> height, min_height;
  /// Description of an unreadable height for messages, to follow the object's name. Empty without
  /// such a height.
  std::string height_problem;
  /// The corners are those of the top, and the solid extends down to the ground (KML's extrude).
  bool reaches_ground = false;
  bool is_thin = false;  ///< Outline around a point or a line; used only with a height.
};

// Contents of a file, with members in the order in which messages describe them.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
struct FileContents {
  std::string format;  ///< Format name, such as "CityGML 2.0".
  std::string crs;     ///< Reference system as named in the file; empty if it names none.
  /// Second reference system that the file uses for a part of its data; empty if unused.
  std::string other_crs;
  /// Coordinates are in the order latitude, longitude, as GML defines for systems named by their
  /// authority.
  bool is_latitude_first = false;
  bool is_local_frame = false;  ///< The file is in a mission frame according to its metadata.
  /// Modelling coordinates: `unit` applies to all three axes, not only to heights.
  bool is_scene = false;
  /// Unit in metres, if the file defines it without a reference system.
  std::optional<double> unit;
  /// Unit of heights in metres, if the file defines it separately.
  std::optional<double> height_unit;
  /// True for y up, false for z up, empty if the file does not define it.
  std::optional<bool> is_y_up;
  /// Vertical datum that the format prescribes if the CRS has none.
  std::optional<HeightDatum> vertical;
  bool is_outlines = false;  ///< Flat polygons, which are extruded.
  /// Map format, whose coordinates are likely to be degrees without a reference system.
  bool is_map = false;
  std::string unknown_unit;              ///< Name of an unknown unit of heights.
  std::vector<Eigen::Vector3d> corners;  ///< Corners of all rings.
  /// Ring i consists of corners [begin[i], begin[i + 1]).
  std::vector<std::uint32_t> ring_begin{0};
  std::vector<FileObject> objects;
  std::vector<Eigen::Vector3d> points;  ///< Points of a cloud.
  bool has_classes = false;             ///< The points have classes.
  std::size_t columns = 0, rows = 0;    ///< Size of a raster.
  /// Nodes of a raster, row by row; z is NaN for nodes without height.
  std::vector<Eigen::Vector3d> nodes;
  /// Steps of a raster: to the next node in the row, and to the node in the next row.
  Eigen::Vector2d right = Eigen::Vector2d::Zero(), down = Eigen::Vector2d::Zero();
  std::vector<std::string> notes;  ///< Sentences for the user.

  /// Adds a polygon to an object.
  FilePolygon& add_polygon(FileObject& object) {
    FilePolygon& polygon = object.polygons.emplace_back();
    polygon.first_ring = static_cast<std::uint32_t>(ring_begin.size() - 1);
    return polygon;
  }
  /// Completes a ring of `polygon`, the last added polygon, from the corners since the previous
  /// ring.
  void close_ring(FilePolygon& polygon) {
    ring_begin.push_back(static_cast<std::uint32_t>(corners.size()));
    ++polygon.rings;
  }
};

/// Limits on the polygons, raster cells, corners and bytes of a file. Indices have 32 bits.
inline constexpr std::size_t max_polygons = 50'000'000, max_cells = 40'000'000,
                             max_corners = 1'000'000'000, max_bytes = std::size_t{2} << 30;

/// Maximum memory of an input file and its parse tree, estimated from element counts. With the data
/// read from the tree, the total is less than 2 GiB.
inline constexpr std::size_t max_tree_bytes = std::size_t{3} << 29;

/// Throws Error{bad_file} if the tree would exceed max_tree_bytes.
void require_tree_fits(const std::filesystem::path& file, std::size_t bytes);

/// Replaces line ends and other control characters by spaces, for text from files in messages.
std::string one_line(std::string text);

/// Throws Error{bad_file} with the one-line message "FILE: WHAT".
[[noreturn]] void fail_file(const std::filesystem::path& file, const std::string& what);

/// Adds a note with the number of points of a cloud that were skipped because they are NaN or
/// infinite.
void note_skipped(std::size_t points, FileContents& contents);

/// Sets the reference system of a cloud, or the mission frame if Skycap wrote the cloud.
void set_wkt(FileContents& contents, const std::string& wkt);

/// Reads CityGML 1 to 3 by local element names (OGC 08-007r1, 12-019, 20-010). A polygon belongs to
/// the innermost enclosing level of detail and to the innermost enclosing feature with a gml:id.
/// References (xlink) are ignored, because their targets are read directly. Rooms, furniture and
/// closure surfaces are skipped with a note.
FileContents parse_citygml(const std::filesystem::path& file, std::string bytes,
                           std::size_t max_objects = 2'000'000);

/// Reads CityJSON 1.0 to 2.0 (OGC 20-072r5) and CityJSONSeq (one feature per line).
FileContents parse_cityjson(const std::filesystem::path& file, std::string_view bytes);

}  // namespace skycap::missions::site_data
