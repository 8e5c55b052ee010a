/// Prior data in the site frame: x east, y north, z up, in metres relative to the site's origin.
/// Missions are planned and exported in the same frame (flight/export/geodesy.h).
///
/// Prior data may be wrong. It never verifies that space is free, and measurements override it.
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

/// Named object of a file: a building, an extruded polygon or a node of a scene.
struct Object {
  std::string id;    ///< Id in the file, otherwise "1", "2", ... in file order.
  std::string kind;  ///< Type name in the file, such as "Building"; empty without one.
  std::map<std::string, std::string> attributes;
  geometry::Mesh mesh;  ///< Unmodified mesh, possibly open and with unreliable orientation.
  std::vector<SurfaceKind> surfaces;  ///< Surface kind of each triangle.
};

/// Position of the site, as far as it is known.
struct SiteFrame {
  std::optional<flight::GeodeticPoint> origin;  ///< Geodetic position of the frame's origin.
  std::optional<double> takeoff_z;              ///< Height of the pad in the frame [m].
  double ground_z = 0.0;  ///< Height of the ground plane where the terrain is unknown [m].
  std::optional<double> undulation;  ///< Geoid undulation at the origin [m].
};

/// Returns the ground height at a position, or an empty value where it is unknown [m].
using TerrainHeight = std::function<std::optional<double>(const Eigen::Vector2d&)>;

/// Min and max height [m].
struct HeightRange {
  double min = 0.0, max = 0.0;
};

/// Selected contents of a file.
struct Prior {
  Role role = Role::obstacle;
  /// Maximum position error [m]. The default is 0.3 for meshes, points and grids, and 1.0 for
  /// extruded outlines. The accuracies of substitute transformations such as EGM96, as stated by
  /// PROJ, are added.
  double uncertainty = 0.0;
  std::vector<Object> objects;
  std::vector<Eigen::Vector3f> points;  ///< Downsampled points of a cloud.
  HeightGrid grid;                      ///< Height grid of a raster; otherwise empty.
  std::string format;                   ///< Format name, such as "CityGML 2.0".
  std::string crs;                      ///< Name of the file's reference system.
  std::size_t dropped_polygons = 0;     ///< Number of polygons without area.
  Eigen::AlignedBox3d box;              ///< Bounding box of all contents in the site frame.
  /// Range of ellipsoidal heights; empty if the position of the site is unknown.
  std::optional<HeightRange> ellipsoid_heights;
  /// Range of heights AMSL; empty if the geoid undulation is unknown.
  std::optional<HeightRange> sea_level_heights;
  std::vector<std::string>
      notes;  ///< Sentences for the user about substitutes, assumptions and omissions.
};

/// Returns true if the mesh has a non-zero area.
bool has_area(const geometry::Mesh& mesh);

/// Reads a file; the format is detected from its contents, then from its extension. Throws Error
/// with a one-line message that starts with the file name.
///
/// Throws {bad_file} if the file is damaged, too large (2 GB; 40 million cells; 50 million
/// polygons), or of unknown format. Throws {bad_config} if a required key of the source is missing
/// (crs, vertical, base, height, takeoff) or a key does not apply to the file. Throws {bad_config}
/// also for data more than 50 km from the site and for unsuitable roles: targets require objects,
/// and terrain requires surfaces and excludes points. `terrain` is used if `base_on_terrain` is
/// set.
Prior read_prior(const Source& source, const SiteFrame& site, const TerrainHeight& terrain = {});

/// Returns the geodetic centre of the selected data, without height, to derive the position of a
/// site. Throws all errors of read_prior(), and Error{bad_config} without a reference system.
flight::GeodeticPoint compute_centre(const Source& source);

/// Default assumptions about a file where it lacks information.
struct Assumptions {
  std::string crs;
  std::optional<HeightDatum> vertical;
  bool has_terrain = false;  ///< Outlines without heights and base are placed on the terrain.
  /// Without `vertical`, heights in a file without a vertical datum are above the geoid, and EGM96
  /// replaces a geoid whose grid is not installed. Outlines without heights are not affected.
  bool has_heights_above_geoid = false;
};

/// Returns the source completed with the assumptions that its file requires. Information in the
/// file has priority. Throws all errors of read_prior().
Source completed(Source source, const Assumptions& assumed);

/// Returns all surfaces of a file as one mesh in metres with z up, relative to the centre of its
/// coordinates, for simulated sensors. Throws all errors of read_prior().
geometry::Mesh read_surfaces(const std::filesystem::path& file);

/// Returns the undulation of the EGM96 geoid relative to the WGS84 ellipsoid [m], from PROJ's grid.
/// Throws Error{bad_file} if PROJ or the grid is not installed.
double egm96_undulation(double latitude_deg, double longitude_deg);

}  // namespace skycap::missions::site_data
