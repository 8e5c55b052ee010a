/// Prior data in the site's frame: x east, y north, z up about the site's origin, in metres, which
/// is the frame that missions are planned in and exported from (flight/export/geodesy.h).
///
/// What a file says is material to doubt: a prior never proves that space is free, and what is
/// measured overrules it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "geometry/surfaces/mesh.h"
#include "missions/site_data/formats/meanings.h"
#include "missions/site_data/height_grid.h"
#include "missions/site_data/source.h"

namespace skycap::missions::site_data {

/// A thing with a name in its file: a building, an extruded polygon, a node of a scene.
struct Object {
  std::string id;    ///< as in the file, or "1", "2", ... in its order
  std::string kind;  ///< the file's word, such as "Building"; empty: it has none
  std::map<std::string, std::string> attributes;
  geometry::Mesh mesh;                ///< as it is: maybe open, orientation not trusted
  std::vector<SurfaceKind> surfaces;  ///< of each triangle
};

/// Where the site is, as far as it is known.
struct SiteFrame {
  std::optional<flight::GeodeticPoint> origin;  ///< of the frame
  std::optional<double> takeoff_z;              ///< of the pad, in the frame
  double ground_z = 0.0;             ///< of the plane that is the ground where no terrain is known
  std::optional<double> undulation;  ///< of the geoid above the ellipsoid there
};

/// z of the ground at a place of the site; nothing where it is not known.
using TerrainHeight = std::function<std::optional<double>(const Eigen::Vector2d&)>;

/// Least and greatest, in metres.
struct HeightRange {
  double least = 0.0, most = 0.0;
};

/// What a file holds, less what `select` leaves out.
struct Prior {
  Role role = Role::obstacle;
  /// The source's; else 0.3 of meshes, points and grids, 1.0 of extruded outlines; and on top of
  /// either what EGM96 or another stand-in in the way to WGS84 may be off, as PROJ states it.
  double uncertainty = 0.0;
  std::vector<Object> objects;
  std::vector<Eigen::Vector3f> points;           ///< of a cloud, thinned
  HeightGrid grid;                               ///< of a raster; empty: it is none
  std::string format;                            ///< such as "CityGML 2.0"
  std::string crs;                               ///< that its coordinates were in, by name
  std::size_t dropped_polygons = 0;              ///< without area
  Eigen::AlignedBox3d box;                       ///< of all of it, in the site's frame
  std::optional<HeightRange> ellipsoid_heights;  ///< if the site is known
  std::optional<HeightRange> sea_level_heights;  ///< if the geoid there is, too
  std::vector<std::string>
      notes;  ///< sentences for the user: stand-ins, guesses, what was left out
};

/// Whether it is a surface at all.
bool has_area(const geometry::Mesh& mesh);

/// Reads a file by its content, then by its ending. Throws Error in one line that opens with the
/// file: {bad_file} if it is broken, too large (2 GB; 40 million cells; 50 million polygons), or
/// of no known format; {bad_config} if the source does not say what is needed (crs, vertical, base,
/// height, takeoff), says what the file has no use for, gives it a role that it cannot play
/// (targets are objects; the ground has an area and is no points), or puts anything farther than 50
/// km from the site. `terrain` is asked where `base_on_terrain` is set.
Prior read_prior(const Source& source, const SiteFrame& site, const TerrainHeight& terrain = {});

/// Where on the Earth the middle of what is selected of a file is, without its height: for those
/// who do not know their site yet. Throws what read_prior() throws, and Error{bad_config} if the
/// file has no reference system.
flight::GeodeticPoint middle_of(const Source& source);

/// What a file is taken to mean where it does not say it.
struct Assumptions {
  std::string crs;
  std::optional<HeightDatum> vertical;
  bool has_terrain = false;  ///< outlines that have neither heights nor a base stand on it
};

/// The source with those of the assumptions that its file needs; what the file says itself stays.
/// Throws what read_prior() throws.
Source completed(Source source, const Assumptions& assumed);

/// All surfaces of a file as one mesh in metres with z up, about the middle of what they are in:
/// what simulated sensors see of a site. Throws what read_prior() throws.
geometry::Mesh read_surfaces(const std::filesystem::path& file);

/// Height of the geoid EGM96 above WGS84's ellipsoid, from PROJ's grid. Throws Error{bad_file} if
/// PROJ or the grid is not installed.
double egm96_undulation(double latitude_deg, double longitude_deg);

}  // namespace skycap::missions::site_data
