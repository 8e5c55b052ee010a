/// A block of 10 x 10 x 10 m in UTM zone 32 (EPSG:25832), 380 to 390 m high, in each supported file
/// format.
#pragma once

#include <array>
#include <functional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "missions/site_data/prior.h"

namespace skycap::testing_support {

struct Cube {
  Eigen::Vector3d low{676300.0, 5403900.0, 380.0};
  Eigen::Vector3d size{10.0, 10.0, 10.0};

  /// Returns corner i. It has the high x if bit 0 is set, the high y for bit 1 and the high z for
  /// bit 2.
  Eigen::Vector3d corner(int i) const {
    return low + Eigen::Vector3d((i & 1) != 0 ? size.x() : 0.0, (i & 2) != 0 ? size.y() : 0.0,
                                 (i & 4) != 0 ? size.z() : 0.0);
  }
  /// Corners of the six faces, counter-clockwise from outside: bottom, top, four walls.
  static constexpr std::array<std::array<int, 4>, 6> faces = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}}};
};

/// Formats x y z with a resolution of 1 mm, joined by the separator.
std::string numbers(const Eigen::Vector3d& offset, const char* separator = " ");

std::string make_citygml(const Cube& cube, const std::string& crs = "EPSG:25832");
std::string make_cityjson(const Cube& cube, const std::string& crs = "EPSG:25832");
std::string make_geojson(const Cube& cube);  ///< outline only
std::string make_obj(const Cube& cube);
/// Returns a GLB file with y up and its low corner at the origin, because single precision is
/// insufficient for map coordinates.
std::string make_glb(const Cube& cube);
/// Returns cells of 0.5 m: the top of the cube, and 20 m lower elsewhere.
std::string make_ascii_grid(const Cube& cube);
/// Returns the corners as a LAS file with a scale of 1 mm. Versions before 1.4 have formats below
/// 6.
std::string make_las(const Cube& cube, int minor, int format, const std::string& wkt = "");

/// Returns the corners as an E57 file: two scans of scaled integers whose poses move them to map
/// coordinates.
std::string make_e57(const Cube& cube, const std::string& reference_system = "");

/// Returns a source for a file with ellipsoidal heights in EPSG:25832.
missions::site_data::Source make_source(const std::filesystem::path& file);

/// Returns a site with its origin 60 m from the cube.
missions::site_data::SiteFrame site_at_cube();

}  // namespace skycap::testing_support
