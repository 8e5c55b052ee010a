/// The Radcliffe Camera, Oxford (James Gibbs, 1737-49), built from a table of dimensions.
///
/// No measured model of it is published. The table says of each dimension where it comes from, so
/// that an estimate can be replaced by a measurement:
///   stated     read in a description of the building: an 18th-century Oxford guide (heights of 80
///              and 60 ft), the list entry and Sherwood & Pevsner (stages, bays, orders), Summerson
///              (bay rhythm, buttresses)
///   derived    follows from stated facts
///   estimate   from the rules of the Corinthian order in Gibbs' own "Rules for Drawing the Several
///              Parts of Architecture" and from general knowledge of views
///
/// Frame: origin on the ground in the middle of the building, x east, y north (the entrance),
/// z up. Projecting arched bays at azimuths 0, 45, 90 ... degrees, niche bays between them.
#pragma once

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

/// All lengths in metres at full size, angles in radians.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
struct RadcliffeTable {
  // The whole.
  double total_height = 42.672;  ///< stated: 140 ft, 80 to the balustrade and 60 above it
  double longest_side = 40.0;    ///< the model's height; the paper surveys it 40 m tall
  int projecting_bays = 8;       ///< stated; as many niche bays between them

  // Ground stage, up to z = 7.6.
  double ground_wall_radius = 14.0;   ///< estimate, at the niche bays
  double projection_front = 15.24;    ///< derived: 100 ft over two projections (19th-c. guides)
  double projection_width = 6.2;      ///< estimate
  double base_course_height = 0.4;    ///< estimate
  double course_height = 0.6;         ///< estimate
  int courses_to_pediment = 10;       ///< estimate, above the base course: pediments at z = 6.4
  int courses = 11;                   ///< estimate, above the base course
  double joint_half_width = 0.03;     ///< estimate; the joints are V-shaped
  double joint_depth = 0.05;          ///< estimate
  double arch_width = 3.2;            ///< estimate
  double arch_crown = 5.6;            ///< estimate
  double arch_depth = 0.9;            ///< estimate; from the front to the glazing of 1863
  double arch_voussoir_height = 0.9;  ///< estimate
  int arch_voussoirs = 13;            ///< estimate
  double ground_niche_width = 1.5;    ///< estimate
  double ground_niche_sill = 1.0;     ///< estimate; a joint between courses
  double ground_niche_crown = 4.75;   ///< estimate
  double ground_niche_depth = 0.75;   ///< estimate
  double ground_niche_voussoir_height = 0.7;  ///< estimate
  int ground_niche_voussoirs = 9;             ///< estimate
  double ground_pediment_rise = 1.3;          ///< estimate
  double ground_cornice_height = 0.6;         ///< estimate
  double ground_cornice_overhang = 0.45;      ///< estimate
  int step_count = 8;                         ///< estimate, north entrance of 1863
  double step_rise = 0.16;                    ///< estimate
  double step_tread = 0.34;                   ///< estimate
  double step_width = 4.0;                    ///< estimate

  // Middle stage: plinth up to z = 8.8, columns up to z = 20.1.
  double plinth_radius = 14.3;          ///< estimate; carries the column bases
  double plinth_height = 1.2;           ///< estimate
  double wall_radius = 13.2;            ///< estimate
  int columns_in_a_group = 2;           ///< stated: coupled columns, a pair between neighbours
  double column_height = 11.3;          ///< estimate: ten diameters, the Corinthian rule
  double column_radius = 0.565;         ///< estimate, at the foot
  double column_radius_at_top = 0.475;  ///< estimate: five sixths
  double column_axis_radius = 13.45;    ///< derived from three quarters standing free of the wall
  double column_spacing = 1.75;         ///< estimate, axis to axis within a pair
  double wide_bay_shift = 0.0105;       ///< estimate: 0.6 degrees make the window bays wider
  int flutes = 24;                      ///< the order's rule, when the shafts are fluted
  double window_width = 1.8;            ///< estimate
  double window_sill = 3.6;             ///< estimate, above the plinth
  double window_height = 4.6;           ///< estimate
  double mezzanine_width = 1.6;         ///< estimate
  double mezzanine_sill = 1.0;          ///< estimate, above the plinth
  double mezzanine_height = 1.5;        ///< estimate
  double window_reveal = 0.45;          ///< estimate
  double niche_width = 1.3;             ///< estimate
  double niche_depth = 0.6;             ///< estimate
  double lower_niche_sill = 1.0;        ///< estimate, above the plinth
  double lower_niche_height = 1.8;      ///< estimate
  double upper_niche_sill = 4.2;        ///< estimate, above the plinth
  double upper_niche_height = 3.2;      ///< estimate

  // Entablature and balustrade, up to z = 24.4.
  double entablature_height = 2.3;       ///< estimate: a fifth of the column
  double cornice_overhang = 1.0;         ///< estimate
  int modillions_in_a_bay = 6;           ///< estimate
  int dentils_in_a_bay = 26;             ///< estimate
  double balustrade_height = 2.0;        ///< derived: what is left of the stated 80 ft
  double balustrade_radius = 13.75;      ///< estimate, its middle line
  double balustrade_base_height = 0.45;  ///< estimate
  double baluster_height = 1.2;          ///< estimate
  double baluster_radius = 0.12;         ///< estimate, at its widest
  double baluster_spacing = 0.36;        ///< estimate
  double pier_width = 0.8;               ///< estimate
  double vase_height = 1.4;              ///< estimate; one on each pier, in line with the columns

  // Drum, up to z = 29.9.
  double drum_radius = 8.5;          ///< estimate
  double drum_height = 5.5;          ///< estimate, above the balustrade's 24.4
  double drum_window_width = 1.8;    ///< estimate; a window over each projecting bay
  double drum_window_height = 3.0;   ///< estimate
  double drum_window_sill = 1.2;     ///< estimate, above z = 24.4
  double drum_window_reveal = 0.4;   ///< estimate
  double drum_cornice_height = 0.8;  ///< estimate
  double buttress_width = 1.8;       ///< estimate; a buttress over each niche bay (Summerson)
  double buttress_projection = 2.2;  ///< estimate
  double buttress_height = 4.5;      ///< estimate, above z = 24.4

  // Dome, lantern, finial.
  double dome_radius = 8.2;             ///< estimate, at the springing
  double dome_rise = 8.4;               ///< estimate; Pevsner: elongated, so more than the radius
  int dome_ribs = 16;                   ///< estimate: 8 or 16
  double rib_width = 0.45;              ///< estimate, at the springing
  double rib_relief = 0.20;             ///< estimate
  int lead_rolls_between_ribs = 3;      ///< estimate
  double lead_roll_radius = 0.04;       ///< estimate
  double lantern_radius = 1.3;          ///< estimate
  double lantern_height = 2.5;          ///< estimate
  int lantern_openings = 8;             ///< estimate
  double lantern_opening_width = 0.56;  ///< estimate
  double cap_height = 0.8;              ///< estimate
  double finial_ball_radius = 0.35;     ///< estimate; its spike reaches the total height

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
  Fineness fineness{0.002};         ///< at the model's size
  bool has_fluted_columns = false;  ///< estimate: the shafts look plain in views
};

/// The building as closed, outward-facing solids that overlap where they meet, scaled to
/// `longest_side`. Deterministic.
Parts radcliffe_camera(const RadcliffeTable& table, const RadcliffeOptions& options);

}  // namespace skycap::sim::models
