/// Standard flight patterns of photogrammetry. They are compared with the plan, provide candidates
/// for it, or replace it.
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

/// nadir: one grid of photos straight down. oblique: the nadir grid and four grids tilted by 45
/// degrees. dome: orbits around the target. facade: rows around the target's hull and the nadir
/// grid.
enum class Pattern { nadir, oblique, dome, facade };

/// Returns "nadir", "oblique", "dome" or "facade".
const char* to_string(Pattern pattern);
/// Returns the pattern with that name, or nullopt for unknown names.
std::optional<Pattern> pattern_named(std::string_view name);

struct PatternOptions {
  double view_distance = 10.0;     ///< View distance d [m].
  double forward_overlap = 0.8;    ///< Overlap of consecutive photos, in [0, 0.95].
  double side_overlap = 0.7;       ///< Overlap of neighbouring rows, in [0, 0.95].
  double ground = 0.0;             ///< z at the base of the target [m].
  double min_height = 0.0;         ///< z of the lowest facade row and orbit [m].
  std::size_t max_photos = 20000;  ///< Limit of the number of photos, including dropped ones.
};

struct PatternPhotos {
  std::vector<geometry::View> views;  ///< Photos in the order of the pattern.
  std::size_t dropped = 0;            ///< Number of photos excluded by the space.
  bool is_too_large = false;  ///< True if the pattern exceeds max_photos. It has no photos then.
};

/// Returns the photos of a pattern around a target. Overlaps refer to the footprint at the view
/// distance, along image height and width. The top of a photo straight down is to the north.
///
/// * nadir: grid at height d above the target's top, over its box extended by 0.15 d; rows run
/// north.
/// * oblique: the nadir grid, and for each cardinal direction a grid at d sin 45 above the top. Its
/// photos face that direction, 45 degrees down. Its forward spacing is multiplied by 1 / cos 45. It
/// is shifted backwards by its height above the middle of the target.
/// * dome: horizontal orbits at 0.4 and 0.9 of the target's height, then orbits at elevations of 30
/// to 75 degrees in steps of 15, with photos that face the middle. Azimuth steps are 15 degrees /
/// cos(elevation). The radius is d plus 0.75 times the half diagonal of the target's horizontal
/// box.
/// * facade: rows along the horizontal convex hull at distance d, with arcs around its corners,
/// from the minimum height to 0.2 d below the top; then the nadir grid.
PatternPhotos pattern_photos(Pattern pattern, const geometry::PhotoCamera& camera,
                             const geometry::Mesh& target, const PatternOptions& options,
                             const PhotoSpace& space);

}  // namespace skycap::survey::photo
