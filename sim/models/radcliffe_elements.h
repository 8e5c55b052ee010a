/// Elements of the Radcliffe Camera at full size, which radcliffe_camera() combines. Each function
/// adds all instances of its element around the building.
#pragma once

#include "sim/models/masonry/solids.h"
#include "sim/models/radcliffe_camera.h"

namespace skycap::sim::models::radcliffe {

/// Common input of all elements.
struct Plan {
  const RadcliffeTable& table;
  Fineness fineness;  ///< At full size.
  bool has_fluted_columns;

  double bay_angle() const;  ///< Returns the angle between two projecting bays.
  /// Returns the azimuth of a projecting bay, which is also that of window bays.
  double arched_bay(int i) const;
  /// Returns the azimuth of a niche bay, which is also that of buttresses.
  double niche_bay(int i) const;
  std::vector<double> columns() const;  ///< Returns the azimuths of all columns.
};

// Returns the body: all parts connected to the wall, from the ground to the finial.
geometry::Mesh body(const Plan& plan);

// Adds elements of the ground stage.
void add_pediments(const Plan& plan, Parts& parts);
void add_keystones(const Plan& plan, Parts& parts);
void add_arch_glazing(const Plan& plan, Parts& parts);
void add_north_steps(const Plan& plan, Parts& parts);

// Adds elements of the middle stage.
void add_columns(const Plan& plan, Parts& parts);
void add_window_frames(const Plan& plan, Parts& parts);
void add_niche_frames(const Plan& plan, Parts& parts);
void add_festoons(const Plan& plan, Parts& parts);
void add_cornice_blocks(const Plan& plan, Parts& parts);

// Adds elements of the balustrade.
void add_balustrade(const Plan& plan, Parts& parts);
void add_vases(const Plan& plan, Parts& parts);

// Adds elements of the drum, the dome and the lantern.
void add_buttresses(const Plan& plan, Parts& parts);
void add_drum_window_frames(const Plan& plan, Parts& parts);
void add_dome_ribs(const Plan& plan, Parts& parts);
void add_lantern_order(const Plan& plan, Parts& parts);

}  // namespace skycap::sim::models::radcliffe
