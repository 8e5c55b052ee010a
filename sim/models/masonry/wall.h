/// Masonry walls along a closed plan, laid out as tiles on their developed face, with joints
/// between stones and recessed openings.
///
/// The face of a wall is developed into the plane with coordinates s and z. s runs along the plan,
/// counter-clockwise from above: to the right of an observer who faces the wall. z is up.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "sim/models/masonry/plan_curve.h"
#include "sim/models/masonry/solids.h"
#include "sim/models/masonry/tower.h"

namespace skycap::sim::models {

/// Recess in a wall's face, mirror-symmetric with a level sill.
struct Opening {
  enum class Back {
    flat,  ///< Panel parallel to the wall: glazing, door or blind recess.
    round  ///< Niche: half an ellipse in plan at every height, which gives a conch under an arch.
  };
  double centre;  ///< Position s of the axis.
  double half_width;
  double sill;   ///< Height z.
  double depth;  ///< Distance from the face to the panel, or to the deepest point of the niche.
  Back back = Back::flat;
  Polyline2 head;  ///< Upper edge from the right end to the left, in (s, z).

  /// Returns z of the upper edge at s, for the piece of the edge above `margin`, which is inside
  /// the opening.
  double head_height(double s, double margin) const;
  Polyline2 outline() const;  ///< Returns the outline, counter-clockwise.
};

/// Returns an opening below a level lintel at z = `head`.
Opening rectangular(double centre, double width, double sill, double head, double depth);
/// Returns an opening below a semicircular arch with the crown at z = `crown`.
Opening arched(double centre, double width, double sill, double crown, double depth,
               const Fineness& fineness);

/// V-shaped grooves between the stones of a rusticated wall [m].
struct Joint {
  double half_width = 0.0;
  double depth = 0.0;
};

struct Wall {
  PlanCurve plan;
  double bottom;  ///< Height z.
  double top;     ///< Height z.
  /// Polygons in (s, z), counter-clockwise, which cover the face except the openings without gaps
  /// or overlaps. A stone around a corner of the plan consists of two tiles.
  std::vector<Polyline2> tiles;
  std::vector<Opening> openings;
  Joint joint = {};
};

/// Covers the face of a wall from `bottom` to `top` and from s = `start` to `end` with tiles,
/// except the openings. Tiles are at most `max_width` wide and not much higher than wide.
std::vector<Polyline2> plain_tiles(double start, double end, double bottom, double top,
                                   const std::vector<Opening>& openings, double max_width);

/// Returns the wall as a surface that is open at the bottom and the top, with the openings filled.
Band build(const Wall& wall);

}  // namespace skycap::sim::models
