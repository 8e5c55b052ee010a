#include <cmath>
#include <numbers>
#include <utility>

#include "sim/models/masonry/rustication.h"
#include "sim/models/masonry/tower.h"
#include "sim/models/masonry/wall.h"
#include "sim/models/radcliffe_dome.h"
#include "sim/models/radcliffe_elements.h"

namespace skycap::sim::models::radcliffe {
namespace {

using std::numbers::pi;

/// Returns the rusticated storey up to the pediments, with alternating projecting arches and
/// niches.
Band rusticated_storey(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  Wall wall{PlanCurve::with_projections(t.ground_wall_radius, t.projecting_bays, t.projection_width,
                                        t.projection_front),
            0.0,
            t.pediment_level(),
            {},
            {},
            {t.joint_half_width, t.joint_depth}};
  const Courses courses{t.base_course_height, t.course_height, t.courses_to_pediment};
  const double period = wall.plan.length() / t.projecting_bays;
  const double half_front = 0.5 * t.projection_width;
  const double side = t.projection_front - std::sqrt(t.ground_wall_radius * t.ground_wall_radius -
                                                     half_front * half_front);
  const double half_niche_bay = 0.5 * period - half_front - side;

  for (int i = 0; i < t.projecting_bays; ++i) {
    const double middle = i * period;
    // The north arch is the entrance above the steps. The others start on the base course.
    const bool is_entrance = i == t.projecting_bays / 4;
    const double sill =
        is_entrance ? t.base_course_height + 2 * t.course_height : t.base_course_height;
    Opening arch = arched(middle, t.arch_width, sill, t.arch_crown, t.arch_depth, plan.fineness);
    add_arched_bay(courses, arch, {t.arch_voussoirs, t.arch_voussoir_height}, half_front,
                   plan.fineness, wall);

    Opening niche = arched(middle + 0.5 * period, t.ground_niche_width, t.ground_niche_sill,
                           t.ground_niche_crown, t.ground_niche_depth, plan.fineness);
    niche.back = Opening::Back::round;
    add_arched_bay(courses, niche, {t.ground_niche_voussoirs, t.ground_niche_voussoir_height},
                   half_niche_bay, plan.fineness, wall);

    add_plain_courses(courses, middle + half_front, middle + half_front + side, wall);
    add_plain_courses(courses, middle - half_front - side, middle - half_front, wall);
  }
  return build(wall);
}

/// Returns the course above, continuous behind the pediments. It is set back by the depth of a
/// joint.
Band upper_courses(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  const double bottom = t.pediment_level();
  const double top = t.base_course_height + t.courses * t.course_height;
  Wall wall{PlanCurve::circle(t.ground_wall_radius - 0.04),
            bottom,
            top,
            {},
            {},
            {t.joint_half_width, t.joint_depth}};
  const int stones = 5 * 2 * t.projecting_bays;
  add_ring_courses(bottom, t.course_height, t.courses - t.courses_to_pediment, stones,
                   plan.fineness, wall);
  return build(wall);
}

Polyline2 ground_cornice_and_plinth(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  const double bottom = t.ground_stage_top() - t.ground_cornice_height;
  const double reach = t.ground_wall_radius + t.ground_cornice_overhang;
  Profile profile(plan.fineness, t.ground_wall_radius + 0.06, bottom);
  profile.by(0.0, 0.16)
      .by(0.04, 0.0)
      .arc_by(0.12, 0.12, -0.5 * pi)
      .to(reach - 0.08, bottom + 0.30)
      .by(0.0, 0.14)
      .wave_by(0.08, 0.10, 0.4 * pi)
      .by(0.0, 0.04)
      .to(t.plinth_radius + 0.08, t.ground_stage_top());
  // Plinth of the order: base, die, cap.
  const double cap = t.column_foot();
  profile.by(0.0, 0.18)
      .wave_by(-0.08, 0.08, 0.4 * pi)
      .to(t.plinth_radius, cap - 0.18)
      .arc_by(0.06, 0.06, -0.5 * pi)
      .by(0.0, 0.09)
      .by(-0.02, 0.03);
  return profile.points();
}

/// Returns the wall behind the columns: windows and niches in two tiers.
Band middle_stage(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  Wall wall{PlanCurve::circle(t.wall_radius), t.column_foot(), t.entablature_foot(), {}, {}};
  for (int i = 0; i < t.projecting_bays; ++i) {
    const double foot = t.column_foot();
    const double window = t.wall_radius * plan.arched_bay(i);
    const double sill = foot + t.window_sill, mezzanine_sill = foot + t.mezzanine_sill;
    wall.openings.push_back(rectangular(window, t.mezzanine_width, mezzanine_sill,
                                        mezzanine_sill + t.mezzanine_height, t.window_reveal));
    wall.openings.push_back(
        rectangular(window, t.window_width, sill, sill + t.window_height, t.window_reveal));
    const double niche = t.wall_radius * plan.niche_bay(i);
    const auto add_niche = [&](double niche_sill, double height) {
      wall.openings.push_back(arched(niche, t.niche_width, foot + niche_sill,
                                     foot + niche_sill + height, t.niche_depth, plan.fineness));
      wall.openings.back().back = Opening::Back::round;
    };
    add_niche(t.lower_niche_sill, t.lower_niche_height);
    add_niche(t.upper_niche_sill, t.upper_niche_height);
  }
  wall.tiles =
      plain_tiles(-0.25 * t.wall_radius * plan.bay_angle(),
                  wall.plan.length() - 0.25 * t.wall_radius * plan.bay_angle(), wall.bottom,
                  wall.top, wall.openings, chord_length(plan.fineness, t.wall_radius));
  return build(wall);
}

/// Returns the architrave with three fasciae, the frieze, and a cornice on dentils and modillions.
/// The base of the balustrade and the lead roof up to the drum follow.
Polyline2 entablature_and_roof(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  const double foot = t.entablature_foot(), top = t.balustrade_foot();
  const double face = t.column_axis_radius + t.column_radius_at_top;
  const double reach = face + t.cornice_overhang;
  Profile profile(plan.fineness, face, foot);
  profile.by(0.0, 0.17)
      .by(0.035, 0.02)
      .by(0.0, 0.20)
      .by(0.035, 0.02)
      .by(0.0, 0.22)
      .wave_by(0.09, 0.09, 0.4 * pi)
      .by(0.0, 0.05)
      .by(-0.16, 0.03);  // Cap of the architrave with a sloping top.
  profile
      .to(face, top - 0.88)  // Frieze.
      .wave_by(0.08, 0.08, -0.4 * pi)
      .by(0.02, 0.0)
      .by(0.0, 0.19)  // Behind the dentils.
      .by(0.10, 0.01)
      .arc_by(0.10, 0.10, 0.5 * pi)
      .by(0.02, 0.0)
      .by(0.0, 0.18)                 // Behind the modillions.
      .to(reach - 0.16, top - 0.30)  // Soffit of the corona.
      .by(0.0, 0.15)
      .wave_by(0.16, 0.11, 0.4 * pi)
      .to(reach, top);
  // Slope of the cornice, base of the balustrade, gutter, roof.
  profile.to(t.balustrade_radius + 0.36, top + 0.06)
      .by(0.0, t.balustrade_base_height - 0.16)
      .by(-0.04, 0.04)
      .to(t.balustrade_radius - 0.32, top + t.balustrade_base_height - 0.06)
      .by(-0.04, -0.04)
      .to(t.balustrade_radius - 0.36, top + 0.1)
      .to(t.drum_radius + 0.5, top + 0.75);
  return profile.points();
}

Polyline2 drum_base(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  Profile profile(plan.fineness, t.drum_radius + 0.35, t.balustrade_foot() + 0.80);
  profile.to(t.drum_radius + 0.35, t.balustrade_top() - 0.2).wave_by(-0.25, 0.2, 0.4 * pi);
  return profile.points();
}

Band drum(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  Wall wall{PlanCurve::circle(t.drum_radius),
            t.balustrade_top(),
            t.dome_foot() - t.drum_cornice_height,
            {},
            {}};
  for (int i = 0; i < t.projecting_bays; ++i) {
    const double sill = wall.bottom + t.drum_window_sill;
    wall.openings.push_back(rectangular(t.drum_radius * plan.arched_bay(i), t.drum_window_width,
                                        sill, sill + t.drum_window_height, t.drum_window_reveal));
  }
  wall.tiles = plain_tiles(-0.5 * t.drum_radius * plan.bay_angle(),
                           wall.plan.length() - 0.5 * t.drum_radius * plan.bay_angle(), wall.bottom,
                           wall.top, wall.openings, chord_length(plan.fineness, t.drum_radius));
  return build(wall);
}

Polyline2 drum_cornice_and_dome(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  const double foot = t.dome_foot() - t.drum_cornice_height, r = t.drum_radius;
  Profile profile(plan.fineness, r + 0.06, foot);
  profile.by(0.0, 0.16)
      .by(0.05, 0.02)
      .arc_by(0.14, 0.14, 0.5 * pi)
      .to(r + 0.52, foot + 0.34)
      .by(0.0, 0.16)
      .wave_by(0.12, 0.12, 0.4 * pi)
      .by(0.0, 0.04)
      .to(t.dome_radius + 0.24, t.dome_foot() - 0.06)
      .by(0.0, 0.22)
      .by(-0.10, 0.04);
  const Meridian meridian(t);
  const int chords = plan.fineness.chords(meridian.radius(), meridian.angle());
  const double start = (0.24 - 0.04) / meridian.radius();  // Above the step before.
  for (int i = 0; i <= chords; ++i) {
    const double angle = start + (meridian.angle() - start) * i / chords;
    profile.to(meridian.point(angle).x(), meridian.point(angle).y());
  }
  // Platform of the lantern.
  const double top = t.lantern_foot();
  profile.to(t.lantern_radius + 0.62, top - 0.02)
      .arc_by(0.0, 0.14, pi)
      .to(t.lantern_radius + 0.34, top + 0.16)
      .by(0.0, 0.16)
      .by(-0.06, 0.06);
  return profile.points();
}

Band lantern(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  const double opening_sill = t.lantern_foot() + 0.62;
  Wall wall{
      PlanCurve::circle(t.lantern_radius), t.lantern_foot() + 0.40, t.cap_foot() - 0.36, {}, {}};
  const double step = wall.plan.length() / t.lantern_openings;
  for (int i = 0; i < t.lantern_openings; ++i) {
    wall.openings.push_back(arched(i * step, t.lantern_opening_width, opening_sill,
                                   t.cap_foot() - 0.62, 0.25, plan.fineness));
  }
  wall.tiles = plain_tiles(-0.5 * step, wall.plan.length() - 0.5 * step, wall.bottom, wall.top,
                           wall.openings, chord_length(plan.fineness, t.lantern_radius));
  return build(wall);
}

/// Returns the cornice and the bell-shaped lead cap of the lantern, then ball and spike, up to the
/// axis.
Polyline2 cap_and_finial(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  const double foot = t.cap_foot(), r = t.lantern_radius, ball = t.finial_ball_radius;
  Profile profile(plan.fineness, r + 0.05, foot - 0.36);
  profile.by(0.0, 0.10)
      .arc_by(0.12, 0.10, 0.5 * pi)
      .by(0.16, 0.0)
      .by(0.0, 0.08)
      .wave_by(0.06, 0.06, 0.4 * pi)
      .to(r + 0.10, foot);
  // Cap: a bell that ends in a neck below the ball.
  const double neck = 0.13, neck_top = foot + t.cap_height;
  profile.arc_to(0.52 * r, foot + 0.62 * t.cap_height, 0.30 * pi)
      .arc_to(neck, neck_top - 0.08, -0.30 * pi)
      .by(0.07, 0.02)
      .by(0.0, 0.05)
      .to(neck, neck_top);
  // Ball, from the neck to the foot of the spike.
  const double spike = 0.07;
  const double below = std::asin(neck / ball), above = std::asin(spike / ball);
  const double ball_height = ball * (std::cos(below) + std::cos(above));
  profile.arc_to(spike, neck_top + ball_height, pi - below - above)
      .to(0.10, neck_top + ball_height + 0.03)
      .to(0.06, neck_top + ball_height + 0.10)
      .to(0.02, t.total_height - 0.02);
  return profile.points();
}

}  // namespace

geometry::Mesh body(const Plan& plan) {
  const RadcliffeTable& t = plan.table;
  const int whole = 2 * t.projecting_bays;  // One vertex on the axis of every bay.
  Tower tower(0.0);
  tower.add(rusticated_storey(plan))
      .add(upper_courses(plan))
      .add(ground_cornice_and_plinth(plan), plan.fineness.circle(t.plinth_radius, whole))
      .add(middle_stage(plan))
      .add(entablature_and_roof(plan), plan.fineness.circle(t.plinth_radius, whole))
      .add(drum_base(plan), plan.fineness.circle(t.drum_radius, whole))
      .add(drum(plan))
      .add(drum_cornice_and_dome(plan), plan.fineness.circle(t.drum_radius, whole))
      .add(lantern(plan))
      .add(cap_and_finial(plan), plan.fineness.circle(t.lantern_radius, whole));
  return tower.close(t.total_height);
}

}  // namespace skycap::sim::models::radcliffe
