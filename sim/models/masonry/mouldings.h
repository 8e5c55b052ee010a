/// Frames, pediments and blocks on walls. All are created at azimuth 0 with x out of the wall, y to
/// the right and z up. Their depth compensates for the curvature of the wall below.
#pragma once

#include <string>

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

/// Gable: a level cornice with returns, the field above it, and cornices on the slopes.
struct Pediment {
  double half_width;  ///< Half width of the wall below.
  double level;       ///< z of the lower edge of the level cornice.
  double rise;        ///< Rise of the field.
  double back;        ///< x of the end inside the wall.
  double front;       ///< x of the wall's face.
  double overhang;    ///< Overhang of the cornices.
  double cornice_height;
  bool is_segmental;  ///< True: an arc instead of two slopes.
};
void add_pediment(const std::string& name, const Pediment& pediment, const Fineness& fineness,
                  Parts& parts);

/// Moulded architrave around three sides of a rectangular opening, and a sill on two blocks. The
/// upper corners have lugs if `lug` is positive.
struct Frame {
  double half_width;  ///< Half width of the opening.
  double sill, head;  ///< z of the opening.
  double back, face;  ///< x inside the wall, and x of the wall's face.
  double band;        ///< Width of the architrave.
  double lug;         ///< Extension of the lugs beyond the architrave.
};
void add_frame(const std::string& name, const Frame& frame, const Fineness& fineness, Parts& parts);

/// Adds glazing bars on a panel at x = `face`: `columns` x `rows` panes between y = -+half_width
/// and z = sill to head.
void add_glazing_bars(const std::string& name, double half_width, double sill, double head,
                      double face, int columns, int rows, const Fineness& fineness, Parts& parts);

/// Adds an arched architrave: legs from the sill to the springing, and a semicircle around the
/// head.
void add_arched_frame(const std::string& name, const Frame& frame, const Fineness& fineness,
                      Parts& parts);

}  // namespace skycap::sim::models
