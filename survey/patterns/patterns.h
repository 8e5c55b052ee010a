/// Standard flight patterns for any sensor. For photos, they are compared with the plan, provide
/// candidates for it, or replace it. For other sensors, they replace the planner.
///
/// World frame: x east, y north, z up [m].
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/pose/pose.h"

namespace skycap::survey::patterns {

/// nadir: one grid of views straight down. oblique: the nadir grid and four tilted grids. dome:
/// orbits around the target. facade: rows around the target's hull and the nadir grid. rings:
/// level circles around the target. corridor: rows on both sides of a line.
enum class Pattern { nadir, oblique, dome, facade, rings, corridor };

/// Returns the name of the pattern, such as "nadir".
const char* to_string(Pattern pattern);
/// Returns the pattern with that name, or nullopt for unknown names.
std::optional<Pattern> pattern_named(std::string_view name);
/// Returns the names of all patterns, separated by commas.
std::string pattern_names();

/// Part of a target that patterns require.
struct PatternTarget {
  Eigen::AlignedBox3d box;
  std::vector<Eigen::Vector2d> outline;  ///< Horizontal convex hull, counter-clockwise.
  std::vector<Eigen::Vector2d> area;     ///< Polygon that grids are limited to; empty: the box.
  std::vector<Eigen::Vector2d> line;     ///< Line of corridors; empty: the long axis of the hull.
  double width = 0.0;                    ///< Width of the structure along `line` [m].
};

/// Returns the target with the extent of points.
PatternTarget target_of(const std::vector<Eigen::Vector3d>& points);
/// Returns the target with the extent of a box.
PatternTarget target_of(const Eigen::AlignedBox3d& box);
/// Returns the target over a simple polygon between two heights.
PatternTarget target_of_polygon(std::vector<Eigen::Vector2d> polygon, double base, double top);
/// Returns the target along a line of at least two points, between two heights.
PatternTarget target_of_line(std::vector<Eigen::Vector2d> line, double width, double base,
                             double top);

/// Return the length of a line and the area of a simple polygon.
double length_of(const std::vector<Eigen::Vector2d>& line);
double area_of(const std::vector<Eigen::Vector2d>& polygon);

struct PatternOptions {
  double view_distance = 10.0;    ///< View distance d [m].
  double forward_overlap = 0.8;   ///< Overlap of consecutive views, in [0, 0.95].
  double side_overlap = 0.7;      ///< Overlap of neighbouring rows, in [0, 0.95].
  double ground = 0.0;            ///< z at the base of the target [m].
  double min_height = 0.0;        ///< z of the lowest view of facade rows, rings and orbits [m].
  std::size_t max_views = 20000;  ///< Limit of the number of views, including dropped ones.
  /// Pitch of oblique grids, facade rows, rings and corridors in [-pi/2, pi/2); default: -45
  /// degrees for oblique and corridor, and 0 for facade and rings. Negative is down [rad].
  std::optional<double> pitch{};
  /// Whether the sensor is a scanner whose axis is along the rows: the image's width is along the
  /// rows of all grids, and oblique rows run across the viewing direction.
  bool is_swept = false;
};

struct PatternViews {
  std::vector<geometry::View> views;  ///< Views in the order of the pattern.
  std::size_t dropped = 0;            ///< Number of views excluded by `allows`.
  bool is_too_large = false;  ///< True if the pattern exceeds max_views. It has no views then.
};

/// Returns whether a view may be used.
using ViewCheck = std::function<bool(const geometry::View&)>;

/// Returns the views of a pattern around a target. `footprint` is the width and height of the
/// sensor's image on a surface at the view distance [m], to which overlaps refer: (1 - overlap)
/// times the footprint is the spacing. The top of an image straight down is to the north. With the
/// pitch p, a view is at the horizontal distance d cos(p) from the surface that it faces and
/// d sin(-p) above it.
///
/// * nadir: grid at height d above the target's top, over its box extended by 0.15 d; rows run
/// north. In a target's area, only views whose footprint may touch the area are kept.
/// * oblique: the nadir grid, and for each cardinal direction a grid at d sin(-p) above the top.
/// Its views face that direction with pitch p. Its spacing along the image height is divided by
/// sin(-p). It is shifted backwards by its height above the middle of the target times cot(-p).
/// * dome: horizontal orbits at 0.4 and 0.9 of the target's height, then orbits at elevations of 30
/// to 75 degrees in steps of 15, with views that face the middle. Azimuth steps are 15 degrees /
/// cos(elevation). The radius is d plus 0.75 times the half diagonal of the target's horizontal
/// box.
/// * facade: rows along the horizontal convex hull at distance d, with arcs around its corners,
/// from the minimum height to 0.2 d below the top; then the nadir grid.
/// * rings: level circles at distance d from the smallest circle around the centre of the target's
/// box that contains its hull. Heights are those of facade.
/// * corridor: rows parallel to the line on both sides of the structure at distance d from it. With
/// a pitch above -45 degrees they have the heights of facade, otherwise one row is on each side of
/// the top. With a pitch of -90 degrees, rows are above the structure at its side overlap; spacing
/// is then from the shorter side of the image.
PatternViews pattern_views(Pattern pattern, const Eigen::Vector2d& footprint,
                           const PatternTarget& target, const PatternOptions& options,
                           const ViewCheck& allows = {});

/// Removes the views between which a sensor measures en route: those at most `position_tolerance`
/// [m] from the straight line between the views that are kept, and whose direction is within
/// `angle_tolerance` [rad] of a constant turn between them. Keeps the first and the last view.
std::vector<geometry::View> without_passed_views(const std::vector<geometry::View>& views,
                                                 double position_tolerance, double angle_tolerance);

}  // namespace skycap::survey::patterns
