/// Flight patterns of photogrammetry, as contestants of a plan, as candidates, and to be flown.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/pose/photo_camera.h"
#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh.h"
#include "survey/photo/candidates.h"

namespace skycap::survey::photo {

/// nadir: one grid of photos straight down. oblique: five grids, of which four are tilted by 45
/// degrees. dome: orbits around the target. facade: rows around the target's hull, and the nadir
/// grid.
enum class Pattern { nadir, oblique, dome, facade };

/// "nadir", "oblique", "dome" or "facade".
const char* to_string(Pattern pattern);
/// The pattern of that name; nothing for other names.
std::optional<Pattern> pattern_named(std::string_view name);

struct PatternOptions {
  double view_distance = 10.0;   ///< d [m]
  double forward_overlap = 0.8;  ///< of consecutive photos; fraction in [0, 0.95]
  double side_overlap = 0.7;     ///< of neighbouring rows; fraction in [0, 0.95]
  double ground = 0.0;           ///< z of the target's foot [m]
  double min_height = 0.0;       ///< z of the lowest row of facades and of orbits [m]
};

struct PatternPhotos {
  std::vector<geometry::View> views;  ///< in the order of the pattern
  std::size_t dropped = 0;            ///< photos that the space does not allow
};

/// The photos of a pattern around a target. Overlaps are of the footprint at the view distance,
/// along image height and width; a photo straight down has its top to the north.
///
/// * nadir: at the target's top plus d over its box plus 0.15 d; rows run north.
/// * oblique: the nadir grid, and for each cardinal direction a grid at the top plus d sin 45. Its
///   photos look there, 45 degrees down. Its forward spacing is stretched by 1 / cos 45. It is
///   shifted back by its height above the middle of the target.
/// * dome: level orbits at 0.4 and 0.9 of the height, then orbits at elevations of 30 to 75 degrees
///   by 15 that look at the middle; azimuth steps of 15 degrees / cos(elevation); radius 0.75 of
///   the half diagonal of the box on the map plus d.
/// * facade: along the convex hull on the map, offset by d, with arcs around its corners, in level
///   rows from the minimum height to the top less 0.2 d; then the nadir grid.
PatternPhotos pattern_photos(Pattern pattern, const geometry::PhotoCamera& camera,
                             const geometry::Mesh& target, const PatternOptions& options,
                             const PhotoSpace& space);

}  // namespace skycap::survey::photo
