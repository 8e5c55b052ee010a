/// What the readers of prior data hand on: a file in its own coordinates, nothing selected, moved
/// or triangulated yet. prior.cpp makes a Prior of it.
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

/// Rings that follow each other: the outline, then holes.
struct FilePolygon {
  std::uint32_t first_ring = 0, rings = 0;
  SurfaceKind kind = SurfaceKind::unknown;
  std::optional<double> lod;  ///< level of detail; none: drawn at all levels
};

struct FileObject {
  std::string id;
  std::optional<std::size_t> parent;  ///< that it is part of; an object before it
  std::string kind;
  std::map<std::string, std::string> attributes;
  std::vector<FilePolygon> polygons;
  bool has_heights = true;  ///< else z of its polygons means nothing
  geometry::Mesh mesh;      ///< of formats that hold triangles
  /// Of flat outlines that stand for solids [m]; none: the polygons are surfaces, or the source
  /// has to say it.
  std::optional<double> height, min_height;
  /// The height that the file states, but that nothing can be made of: what a message says behind
  /// the object's name. Empty: there is none.
  std::string height_problem;
  /// Its corners are those of its top, and it reaches down to the ground (KML's extrude).
  bool reaches_ground = false;
  bool is_thin = false;  ///< drawn around a point or a line: it counts only with a height
};

// In the order in which it is told.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
struct FileContents {
  std::string format;     ///< such as "CityGML 2.0"
  std::string crs;        ///< as the file has it; empty: it says nothing
  std::string other_crs;  ///< a second one that it names for some of it; empty: it does not
  /// Its coordinates are latitude, longitude, as GML has them by the letter of its authority.
  bool is_latitude_first = false;
  bool is_local_frame = false;  ///< the file says that it is in a mission's frame
  /// Its coordinates are a modeller's: `unit` is of all three, not of heights alone.
  bool is_scene = false;
  std::optional<double> unit;           ///< metres, if the file says it and has no reference system
  std::optional<double> height_unit;    ///< metres, if the file says it of heights alone
  std::optional<bool> is_y_up;          ///< if the file says it
  std::optional<HeightDatum> vertical;  ///< that the format prescribes where the CRS is silent
  bool is_outlines = false;             ///< flat polygons: they are extruded
  bool is_map = false;       ///< of a format of maps: without a system degrees are likely
  std::string unknown_unit;  ///< of heights, that the file names and is not known
  std::vector<Eigen::Vector3d> corners;      ///< of all rings
  std::vector<std::uint32_t> ring_begin{0};  ///< ring i is corners [begin[i], begin[i + 1])
  std::vector<FileObject> objects;
  std::vector<Eigen::Vector3d> points;  ///< of a cloud
  bool has_classes = false;             ///< of its points
  std::size_t columns = 0, rows = 0;    ///< of a raster
  std::vector<Eigen::Vector3d> nodes;   ///< of a raster, row by row; z NaN: none
  /// Of a raster: from a node to the next of its row, and to that below it.
  Eigen::Vector2d right = Eigen::Vector2d::Zero(), down = Eigen::Vector2d::Zero();
  std::vector<std::string> notes;  ///< sentences for the user

  /// Begins a polygon of an object.
  FilePolygon& add_polygon(FileObject& object) {
    FilePolygon& polygon = object.polygons.emplace_back();
    polygon.first_ring = static_cast<std::uint32_t>(ring_begin.size() - 1);
    return polygon;
  }
  /// The corners since the last ring are a ring of a polygon, the one that was begun last.
  void close_ring(FilePolygon& polygon) {
    ring_begin.push_back(static_cast<std::uint32_t>(corners.size()));
    ++polygon.rings;
  }
};

/// Most corners, points and nodes that a file may have: 32 bits count them.
inline constexpr std::size_t most_polygons = 50'000'000, most_cells = 40'000'000,
                             most_corners = 1'000'000'000, most_bytes = std::size_t{2} << 30;

/// Most bytes of a text and of the tree that a parser makes of it, by what is counted in the text:
/// with what is read of the tree less than 2 GiB.
inline constexpr std::size_t most_tree_bytes = std::size_t{3} << 29;

/// Throws Error{bad_file} if a tree would take more.
void require_tree_fits(const std::filesystem::path& file, std::size_t bytes);

/// What a file says, for a message: line ends and other control characters become blanks.
std::string one_line(std::string text);

/// Throws Error{bad_file}: "FILE: WHAT", in one line.
[[noreturn]] void fail_file(const std::filesystem::path& file, const std::string& what);

/// Notes how many points of a cloud were skipped, since they are NaN or infinite.
void note_skipped(std::size_t points, FileContents& contents);

/// The reference system of a cloud, or the mission's frame, as our own scans name it.
void set_wkt(FileContents& contents, const std::string& wkt);

/// CityGML 1 to 3, by local names (OGC 08-007r1, 12-019, 20-010). A polygon belongs to the nearest
/// level of detail around it, and to the nearest feature with a gml:id. References (xlink) are
/// passed over, since what they point at is met where it stands. Rooms, furniture and closure
/// surfaces are left out, with a note.
FileContents parse_citygml(const std::filesystem::path& file, std::string bytes,
                           std::size_t most_objects = 2'000'000);

/// CityJSON 1.0 to 2.0 (OGC 20-072r5), and CityJSONSeq: one feature a line.
FileContents parse_cityjson(const std::filesystem::path& file, std::string_view bytes);

}  // namespace skycap::missions::site_data
