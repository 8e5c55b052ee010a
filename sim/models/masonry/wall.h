/// Masonry: walls along a closed plan, laid out as tiles on their developed face, with joints
/// between the stones and openings sunk into them.
///
/// A wall's face is developed into the plane: s runs along the plan, counter-clockwise seen from
/// above (to the right of someone who looks at the wall), z runs up.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "sim/models/masonry/plan_curve.h"
#include "sim/models/masonry/solids.h"
#include "sim/models/masonry/tower.h"

namespace skycap::sim::models {

/// A hole in a wall's face, mirror-symmetric, with a level sill.
struct Opening {
  enum class Back {
    flat,  ///< a panel parallel to the wall: glazing, a door, a blind recess
    round  ///< a niche: half an ellipse in plan at every height, so a conch under an arch
  };
  double centre;  ///< s of its axis
  double half_width;
  double sill;   ///< z
  double depth;  ///< from the face to the panel, or to the deepest point of the niche
  Back back = Back::flat;
  Polyline2 head;  ///< its upper edge, from the right end to the left, in (s, z)

  /// z at s of the upper edge's piece above `beside`, which is inside the opening.
  double head_height(double s, double beside) const;
  Polyline2 outline() const;  ///< counter-clockwise
};

/// An opening under a level lintel at z = `head`.
Opening rectangular(double centre, double width, double sill, double head, double depth);
/// An opening under a semicircular arch whose crown is at z = `crown`.
Opening arched(double centre, double width, double sill, double crown, double depth,
               const Fineness& fineness);

/// The joints between the stones of a rusticated wall: V-shaped grooves.
struct Joint {
  double half_width = 0.0;
  double depth = 0.0;
};

struct Wall {
  PlanCurve plan;
  double bottom;  ///< z
  double top;     ///< z
  /// Polygons in (s, z), counter-clockwise, that cover the face but for the openings without gap or
  /// overlap. A stone that reaches round a corner of the plan is two tiles.
  std::vector<Polyline2> tiles;
  std::vector<Opening> openings;
  Joint joint = {};
};

/// Covers the face of a wall from `bottom` to `top` and s from `start` to `end` with tiles no wider
/// than given and not much higher than wide, leaving out the openings.
std::vector<Polyline2> plain_tiles(double start, double end, double bottom, double top,
                                   const std::vector<Opening>& openings, double max_width);

/// The wall as a surface that is open below and above, openings filled.
Band build(const Wall& wall);

}  // namespace skycap::sim::models
