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

  double bay_angle() const;  ///< Angle between two projecting bays.
  /// Azimuth of a projecting bay, which is also that of window bays.
  double arched_bay(int i) const;
  double niche_bay(int i) const;  ///< Azimuth of a niche bay, which is also that of buttresses.
  std::vector<double> columns() const;  ///< Azimuths of all columns.
};

// Returns the body: all parts connected to the wall, from the ground to the finial.
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
