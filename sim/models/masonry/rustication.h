/// Courses of cut stones around arched openings, as tiles of a wall with joints.
#pragma once

#include "sim/models/masonry/solids.h"
#include "sim/models/masonry/wall.h"

namespace skycap::sim::models {

/// Equal courses on a base course with its own height, from z = 0.
struct Courses {
  double base_height;
  double height;
  int count;  ///< Number of courses above the base course.

  double level(int course) const { return course == 0 ? 0.0 : base_height + (course - 1) * height; }
};

/// Wedge-shaped stones of an arch.
struct Voussoirs {
  int count;
  double height;  ///< Radial height.
};

/// Adds a bay with an arched opening. It extends by `half_width` to each side of the axis, with
/// staggered courses that end at a ring of voussoirs. Sill and springing must be joints between
/// courses, and the voussoirs must be inside the bay.
void add_arched_bay(const Courses& courses, const Opening& opening, const Voussoirs& voussoirs,
                    double half_width, const Fineness& fineness, Wall& wall);

/// Adds courses of single stones from s = `start` to `end`.
void add_plain_courses(const Courses& courses, double start, double end, Wall& wall);

/// Adds `count` staggered courses of `stones` equal stones around a circular wall.
void add_ring_courses(double bottom, double height, int count, int stones, const Fineness& fineness,
                      Wall& wall);

}  // namespace skycap::sim::models
