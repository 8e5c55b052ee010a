/// Radcliffe Camera, Oxford (James Gibbs, 1737-49), generated from a table of dimensions.
///
/// No measured model of it is published. The table lists the source of each dimension, so that an
/// estimate can be replaced by a measurement. Dimensions without a source are estimates: from the
/// rules of the Corinthian order in Gibbs' own "Rules for Drawing the Several Parts of
/// Architecture" and from general knowledge of views.
///
/// Stated dimensions come from descriptions of the building. These are an 18th-century Oxford guide
/// (heights of 80 and 60 ft); the list entry and Sherwood & Pevsner (stages, bays, orders); and
/// Summerson (bay rhythm, buttresses). Derived dimensions follow from stated facts.
///
/// Frame: origin on the ground in the middle of the building, x east, y north (the entrance), z up.
/// Projecting arched bays are at azimuths 0, 45, 90 ... degrees, with niche bays between them.
#pragma once

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

/// Dimensions of the building: lengths in metres at full size, angles in radians.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
struct RadcliffeTable {
  // Complete building.
  double total_height = 42.672;  ///< Stated: 140 ft, 80 to the balustrade and 60 above it.
  /// Maximum extent of the model, which is its height. The paper surveys it 40 m tall.
  double longest_side = 40.0;
  int projecting_bays = 8;  ///< Stated, with the same number of niche bays between them.

  // Ground stage, up to z = 7.6.
  double ground_wall_radius = 14.0;  ///< At the niche bays.
  double projection_front = 15.24;   ///< Derived: 100 ft over two projections (19th-c. guides).
  double projection_width = 6.2;
  double base_course_height = 0.4;
  double course_height = 0.6;
  int courses_to_pediment = 10;    ///< Above the base course: pediments at z = 6.4.
  int courses = 11;                ///< Above the base course.
  double joint_half_width = 0.03;  ///< The joints are V-shaped.
  double joint_depth = 0.05;
  double arch_width = 3.2;
  double arch_crown = 5.6;
  double arch_depth = 0.9;  ///< From the front to the glazing of 1863.
  double arch_voussoir_height = 0.9;
  int arch_voussoirs = 13;
  double ground_niche_width = 1.5;
  double ground_niche_sill = 1.0;  ///< Height of a joint between courses.
  double ground_niche_crown = 4.75;
  double ground_niche_depth = 0.75;
  double ground_niche_voussoir_height = 0.7;
  int ground_niche_voussoirs = 9;
  double ground_pediment_rise = 1.3;
  double ground_cornice_height = 0.6;
  double ground_cornice_overhang = 0.45;
  int step_count = 8;  ///< North entrance of 1863.
  double step_rise = 0.16;
  double step_tread = 0.34;
  double step_width = 4.0;

  // Middle stage: plinth up to z = 8.8, columns up to z = 20.1.
  double plinth_radius = 14.3;  ///< Carries the column bases.
  double plinth_height = 1.2;
  double wall_radius = 13.2;
  int columns_in_a_group = 2;    ///< Stated: coupled columns, one pair between neighbouring bays.
  double column_height = 11.3;   ///< Ten diameters, according to the Corinthian rule.
  double column_radius = 0.565;  ///< At the foot.
  double column_radius_at_top = 0.475;  ///< Five sixths of the foot radius.
  /// Derived: three quarters of each column stand free of the wall.
  double column_axis_radius = 13.45;
  double column_spacing = 1.75;    ///< Axis to axis within a pair.
  double wide_bay_shift = 0.0105;  ///< 0.6 degrees, which widens the window bays.
  int flutes = 24;                 ///< Rule of the order, for fluted shafts.
  double window_width = 1.8;
  double window_sill = 3.6;  ///< Above the plinth.
  double window_height = 4.6;
  double mezzanine_width = 1.6;
  double mezzanine_sill = 1.0;  ///< Above the plinth.
  double mezzanine_height = 1.5;
  double window_reveal = 0.45;
  double niche_width = 1.3;
  double niche_depth = 0.6;
  double lower_niche_sill = 1.0;  ///< Above the plinth.
  double lower_niche_height = 1.8;
  double upper_niche_sill = 4.2;  ///< Above the plinth.
  double upper_niche_height = 3.2;

  // Entablature and balustrade, up to z = 24.4.
  double entablature_height = 2.3;  ///< A fifth of the column height.
  double cornice_overhang = 1.0;
  int modillions_in_a_bay = 6;
  int dentils_in_a_bay = 26;
  double balustrade_height = 2.0;    ///< Derived: remainder of the stated 80 ft.
  double balustrade_radius = 13.75;  ///< Radius of its middle line.
  double balustrade_base_height = 0.45;
  double baluster_height = 1.2;
  double baluster_radius = 0.12;  ///< At its widest.
  double baluster_spacing = 0.36;
  double pier_width = 0.8;
  double vase_height = 1.4;  ///< One per pier, aligned with the columns.

  // Drum, up to z = 29.9.
  double drum_radius = 8.5;
  double drum_height = 5.5;        ///< Above the balustrade's 24.4.
  double drum_window_width = 1.8;  ///< A window over each projecting bay.
  double drum_window_height = 3.0;
  double drum_window_sill = 1.2;  ///< Above z = 24.4.
  double drum_window_reveal = 0.4;
  double drum_cornice_height = 0.8;
  double buttress_width = 1.8;  ///< A buttress over each niche bay (Summerson).
  double buttress_projection = 2.2;
  double buttress_height = 4.5;  ///< Above z = 24.4.

  // Dome, lantern and finial.
  double dome_radius = 8.2;  ///< At the springing.
  double dome_rise = 8.4;    ///< More than the radius: elongated according to Pevsner.
  int dome_ribs = 16;        ///< The actual number is 8 or 16.
  double rib_width = 0.45;   ///< At the springing.
  double rib_relief = 0.20;
  int lead_rolls_between_ribs = 3;
  double lead_roll_radius = 0.04;
  double lantern_radius = 1.3;
  double lantern_height = 2.5;
  int lantern_openings = 8;
  double lantern_opening_width = 0.56;
  double cap_height = 0.8;
  double finial_ball_radius = 0.35;  ///< Its spike reaches the total height.

  double ground_stage_top() const {
    return base_course_height + courses * course_height + ground_cornice_height;
  }
  double pediment_level() const { return base_course_height + courses_to_pediment * course_height; }
  double column_foot() const { return ground_stage_top() + plinth_height; }
  double entablature_foot() const { return column_foot() + column_height; }
  double balustrade_foot() const { return entablature_foot() + entablature_height; }
  double balustrade_top() const { return balustrade_foot() + balustrade_height; }
  double dome_foot() const { return balustrade_top() + drum_height; }
  double lantern_foot() const { return dome_foot() + dome_rise; }
  double cap_foot() const { return lantern_foot() + lantern_height; }
};

struct RadcliffeOptions {
  Fineness fineness{0.002};         ///< At the scale of the model.
  bool has_fluted_columns = false;  ///< Estimated as false: the shafts appear plain in views.
};

/// Returns the building as closed, outward-facing solids that overlap where they meet, scaled to
/// `longest_side`. Deterministic.
Parts radcliffe_camera(const RadcliffeTable& table, const RadcliffeOptions& options);

}  // namespace skycap::sim::models
