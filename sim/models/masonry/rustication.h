/// Courses of cut stones round arched openings: tiles for a wall with joints.
#pragma once

#include "sim/models/masonry/solids.h"
#include "sim/models/masonry/wall.h"

namespace skycap::sim::models {

/// Equal courses on a base course of its own height, from z = 0.
struct Courses {
  double base_height;
  double height;
  int count;  ///< above the base course

  double level(int course) const { return course == 0 ? 0.0 : base_height + (course - 1) * height; }
};

/// The wedge-shaped stones of an arch.
struct Voussoirs {
  int count;
  double height;  ///< radially
};

/// A bay `half_width` to each side of an arched opening's axis: courses that break joint, cut off
/// by a ring of voussoirs. Adds the opening too. Its sill and springing must be joints between
/// courses, and the voussoirs must stay within the bay.
void add_arched_bay(const Courses& courses, const Opening& opening, const Voussoirs& voussoirs,
                    double half_width, const Fineness& fineness, Wall& wall);

/// Courses of single stones from s = `start` to `end`.
void add_plain_courses(const Courses& courses, double start, double end, Wall& wall);

/// `count` courses of `stones` equal stones each all round a circular wall, breaking joint.
void add_ring_courses(double bottom, double height, int count, int stones, const Fineness& fineness,
                      Wall& wall);

}  // namespace skycap::sim::models
