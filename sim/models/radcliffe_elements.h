/// The elements of the Radcliffe Camera, at full size; radcliffe_camera() puts them together.
/// Each function adds every instance of its element all round the building.
#pragma once

#include "sim/models/masonry/solids.h"
#include "sim/models/radcliffe_camera.h"

namespace skycap::sim::models::radcliffe {

/// What every element is made from.
struct Plan {
  const RadcliffeTable& table;
  Fineness fineness;  ///< at full size
  bool has_fluted_columns;

  double bay_angle() const;             ///< from a projecting bay to the next
  double arched_bay(int i) const;       ///< azimuth of a projecting bay, also of window bays
  double niche_bay(int i) const;        ///< azimuth of a niche bay, also of buttresses
  std::vector<double> columns() const;  ///< azimuths of all columns
};

// The body: everything that is one with the wall, from the ground to the finial.
geometry::Mesh body(const Plan& plan);

// Ground stage.
void add_pediments(const Plan& plan, Parts& parts);
void add_keystones(const Plan& plan, Parts& parts);
void add_arch_glazing(const Plan& plan, Parts& parts);
void add_north_steps(const Plan& plan, Parts& parts);

// Middle stage.
void add_columns(const Plan& plan, Parts& parts);
void add_window_frames(const Plan& plan, Parts& parts);
void add_niche_frames(const Plan& plan, Parts& parts);
void add_festoons(const Plan& plan, Parts& parts);
void add_cornice_blocks(const Plan& plan, Parts& parts);

// Balustrade.
void add_balustrade(const Plan& plan, Parts& parts);
void add_vases(const Plan& plan, Parts& parts);

// Drum, dome, lantern.
void add_buttresses(const Plan& plan, Parts& parts);
void add_drum_window_frames(const Plan& plan, Parts& parts);
void add_dome_ribs(const Plan& plan, Parts& parts);
void add_lantern_order(const Plan& plan, Parts& parts);

}  // namespace skycap::sim::models::radcliffe
