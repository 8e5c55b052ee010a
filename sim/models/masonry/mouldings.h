/// Frames, pediments and blocks that are applied to walls. All stand at azimuth 0 with x out of the
/// wall, y to the right, z up; a wall's curvature under them is taken up by their depth.
#pragma once

#include <string>

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

/// A gable: a level cornice with returns, the field above it, and cornices on its slopes.
struct Pediment {
  double half_width;  ///< of the wall it crowns
  double level;       ///< z of the level cornice's lower edge
  double rise;        ///< of the field
  double back;        ///< x at which it ends inside the wall
  double front;       ///< x of the wall's face
  double overhang;    ///< of the cornices
  double cornice_height;
  bool is_segmental;  ///< an arc instead of two slopes
};
void add_pediment(const std::string& name, const Pediment& pediment, const Fineness& fineness,
                  Parts& parts);

/// A moulded architrave round three sides of a rectangular opening, lugged at its upper corners if
/// `lug` is positive, and a sill on two blocks.
struct Frame {
  double half_width;  ///< of the opening
  double sill, head;  ///< z of the opening
  double back, face;  ///< x inside the wall, and x of the wall's face
  double band;        ///< width of the architrave
  double lug;         ///< how far the lugs reach out beyond the architrave
};
void add_frame(const std::string& name, const Frame& frame, const Fineness& fineness, Parts& parts);

/// Glazing bars on a panel at x = `face`: `columns` x `rows` panes between y = -+half_width and z =
/// sill to head.
void add_glazing_bars(const std::string& name, double half_width, double sill, double head,
                      double face, int columns, int rows, const Fineness& fineness, Parts& parts);

/// An arched architrave: legs from the sill up to the springing and a half circle round the head.
void add_arched_frame(const std::string& name, const Frame& frame, const Fineness& fineness,
                      Parts& parts);

}  // namespace skycap::sim::models
