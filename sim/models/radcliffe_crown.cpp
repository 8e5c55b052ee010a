#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/models/masonry/mouldings.h"
#include "sim/models/radcliffe_dome.h"
#include "sim/models/radcliffe_elements.h"

namespace skycap::sim::models::radcliffe {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;

/// Moves solids from the axis to (radius, 0, z).
Mesh standing_at(Mesh mesh, double radius, double z) {
  return moved(std::move(mesh), {radius, 0.0, z});
}

Mesh baluster(const Plan& plan, double height) {
  const double r = plan.table.baluster_radius, h = height;
  Profile profile(plan.fineness, 0.0, -0.03);
  profile.to(0.95 * r, -0.03)
      .to(0.95 * r, 0.10 * h)
      .to(0.60 * r, 0.13 * h)
      .arc_to(0.52 * r, 0.52 * h, 0.45 * pi)  // Belly.
      .to(0.42 * r, 0.78 * h)                 // Neck.
      .arc_by(0.0, 0.07 * h, 0.6 * pi)
      .to(0.46 * r, 0.89 * h)
      .to(0.95 * r, 0.92 * h)
      .to(0.95 * r, h + 0.03)
      .to(0.0, h + 0.03);
  return revolve(profile.points(), plan.fineness.circle(r));
}

/// Returns a vase with a gadrooned bowl, a lid and a pine cone.
Mesh vase(const Plan& plan) {
  const double h = plan.table.vase_height;
  Profile profile(plan.fineness, 0.0, -0.04);
  profile.to(0.24 * h, -0.04)
      .to(0.24 * h, 0.05 * h)
      .arc_to(0.10 * h, 0.16 * h, -0.4 * pi)
      .by(0.03 * h, 0.015 * h)
      .by(0.0, 0.025 * h)
      .to(0.12 * h, 0.215 * h)
      .arc_to(0.30 * h, 0.47 * h, 0.40 * pi)  // Bowl.
      .by(-0.015 * h, 0.03 * h)
      .arc_to(0.20 * h, 0.60 * h, -0.35 * pi)  // Neck.
      .arc_to(0.27 * h, 0.66 * h, -0.30 * pi)
      .by(0.0, 0.03 * h)
      .to(0.20 * h, 0.72 * h)
      .arc_to(0.07 * h, 0.79 * h, -0.3 * pi)  // Lid.
      .arc_to(0.02 * h, 0.99 * h, 0.65 * pi)  // Cone.
      .to(0.0, h);
  return revolve(profile.points(), plan.fineness.circle(0.3 * h));
}

/// Returns a disc in the plane y = const: the eye of a scroll on the sides of a buttress.
Mesh scroll_disc(const Vector2d& centre, double radius, double half_width, const Plan& plan) {
  Profile profile(plan.fineness, 0.0, -half_width);
  profile.to(0.55 * radius, -half_width)
      .to(0.62 * radius, -half_width + 0.06)
      .to(0.80 * radius, -half_width + 0.06)
      .to(0.86 * radius, -half_width)
      .to(radius, -half_width)
      .to(radius, half_width)
      .to(0.86 * radius, half_width)
      .to(0.80 * radius, half_width - 0.06)
      .to(0.62 * radius, half_width - 0.06)
      .to(0.55 * radius, half_width)
      .to(0.0, half_width);
  Mesh disc = revolve(profile.points(), plan.fineness.circle(radius));
  transform(disc, Eigen::Affine3d(Eigen::Translation3d(centre.x(), 0.0, centre.y())) *
                      Eigen::AngleAxisd(0.5 * pi, Vector3d::UnitX()));
  return disc;
}

/// Returns a band on the dome along the meridian at azimuth 0. The section at each position results
/// from the half width there and points (fraction of the half width, distance out of the shell).
template <typename HalfWidth>
Mesh on_meridian(const Plan& plan, double from, double to, const Polyline2& section,
                 HalfWidth half_width) {
  const Meridian meridian(plan.table);
  const int chords = plan.fineness.chords(meridian.radius(), to - from);
  std::vector<Polyline3> rings;
  for (int i = 0; i <= chords; ++i) {
    const double angle = from + (to - from) * i / chords;
    const double width = half_width((angle - from) / (to - from));
    Polyline3& ring = rings.emplace_back();
    for (const Vector2d& point : section) {
      const Vector2d at = meridian.point(angle, point.y());
      ring.emplace_back(at.x(), width * point.x(), at.y());
    }
  }
  return loft(rings);
}

}  // namespace

void add_balustrade(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const double foot = t.balustrade_foot() + t.balustrade_base_height - 0.06;
  const double rail = foot + t.baluster_height;
  const double r = t.balustrade_radius;

  Profile profile(plan.fineness, r - 0.20, rail);
  profile.to(r + 0.20, rail)
      .by(0.0, 0.08)
      .arc_by(0.10, 0.10, 0.4 * pi)
      .to(r + 0.30, t.balustrade_top() - 0.06)
      .to(r, t.balustrade_top() - 0.02)
      .to(r - 0.30, t.balustrade_top() - 0.06)
      .to(r - 0.30, rail + 0.18)
      .arc_by(0.10, -0.10, 0.4 * pi);
  parts.push_back({"balustrade rail",
                   revolve_ring(profile.points(), plan.fineness.circle(r, 2 * t.projecting_bays))});

  const double half = 0.5 * t.pier_width;
  const Mesh pier =
      box({r - half, -half, foot - 0.05}, {r + half, half, t.balustrade_top() - 0.04});
  const Mesh pier_cap = box({r - half - 0.06, -half - 0.06, t.balustrade_top() - 0.16},
                            {r + half + 0.06, half + 0.06, t.balustrade_top() + 0.04});
  const Mesh pier_base = box({r - half - 0.05, -half - 0.05, foot - 0.08},
                             {r + half + 0.05, half + 0.05, foot + 0.12});
  const Mesh one = standing_at(baluster(plan, t.baluster_height), r, foot);
  const std::vector<double> piers = plan.columns();
  for (std::size_t i = 0; i < piers.size(); ++i) {
    parts.push_back({"balustrade pier", turned(pier, piers[i])});
    parts.push_back({"balustrade pier cap", turned(pier_cap, piers[i])});
    parts.push_back({"balustrade pier base", turned(pier_base, piers[i])});
    const double next = i + 1 < piers.size() ? piers[i + 1] : piers[0] + 2.0 * pi;
    const double gap = r * (next - piers[i]) - t.pier_width;
    const int count = std::max(1, static_cast<int>(std::lround(gap / t.baluster_spacing)) - 1);
    for (int j = 1; j <= count; ++j) {
      const double along = 0.5 * t.pier_width + gap * j / (count + 1);
      parts.push_back({"baluster", turned(one, piers[i] + along / r)});
    }
  }
}

void add_vases(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const Mesh one = standing_at(vase(plan), t.balustrade_radius, t.balustrade_top() + 0.04);
  for (const double azimuth : plan.columns()) parts.push_back({"vase", turned(one, azimuth)});
}

void add_buttresses(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const double foot = t.balustrade_foot() + 0.5, level = t.balustrade_top();
  const double inner = t.drum_radius - 0.3, outer = t.drum_radius + t.buttress_projection;
  const double top = level + t.buttress_height, half = 0.5 * t.buttress_width;
  const double lower_scroll = 0.62, upper_scroll = 0.38;

  // Pedestal, then the scroll: out and over the lower volute, and in a hollow up to the upper one.
  const Mesh pedestal = box({inner, -half - 0.10, foot}, {outer + 0.08, half + 0.10, level + 0.45});
  const Vector2d lower(outer - lower_scroll, level + 0.40 + lower_scroll);
  const Vector2d upper(t.drum_radius + 0.62 + upper_scroll, top - upper_scroll);
  Profile profile(plan.fineness, inner, level + 0.3);
  profile.to(outer - lower_scroll, level + 0.40)
      .arc_to(outer - 0.35 * lower_scroll, lower.y() + 0.75 * lower_scroll, 0.76 * pi)
      .arc_to(upper.x() + 0.55 * upper_scroll, upper.y() - 0.8 * upper_scroll, -0.36 * pi)
      .arc_to(upper.x(), top, 0.8 * pi)
      .to(inner, top);
  const Mesh console = turned(extrude(profile.points(), -half, half), -0.5 * pi);
  Parts one;
  one.push_back({"buttress pedestal", pedestal});
  one.push_back({"buttress console", console});
  one.push_back({"buttress scroll", scroll_disc(lower, lower_scroll, half + 0.07, plan)});
  one.push_back({"buttress scroll", scroll_disc(upper, upper_scroll, half + 0.05, plan)});
  // Fillet along its back, and a cap block below the drum's cornice.
  one.push_back({"buttress cap", box({inner, -half - 0.06, top - 0.06},
                                     {upper.x() + 0.30, half + 0.06, top + 0.16})});
  one.push_back({"buttress pilaster", box({inner, -half + 0.12, top + 0.10},
                                          {t.drum_radius + 0.30, half - 0.12,
                                           t.dome_foot() - t.drum_cornice_height + 0.05})});
  for (int i = 0; i < t.projecting_bays; ++i) {
    for (const Part& part : one) {
      parts.push_back({part.name, turned(part.mesh, plan.niche_bay(i))});
    }
  }
}

void add_drum_window_frames(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  Frame frame;
  frame.half_width = 0.5 * t.drum_window_width;
  frame.sill = t.balustrade_top() + t.drum_window_sill;
  frame.head = frame.sill + t.drum_window_height;
  frame.face = t.drum_radius;
  const double reach = frame.half_width + 0.5;
  frame.back = std::sqrt(t.drum_radius * t.drum_radius - reach * reach) - 0.06;
  frame.band = 0.26;
  frame.lug = 0.14;
  Parts bay;
  add_frame("drum window", frame, plan.fineness, bay);
  add_glazing_bars("drum window bar", frame.half_width, frame.sill, frame.head,
                   t.drum_radius - t.drum_window_reveal, 4, 5, plan.fineness, bay);
  bay.push_back({"drum window keystone", extrude({{-0.16, frame.head - 0.04},
                                                  {0.16, frame.head - 0.04},
                                                  {0.24, frame.head + 0.42},
                                                  {-0.24, frame.head + 0.42}},
                                                 frame.back, t.drum_radius + 0.18)});
  for (int i = 0; i < t.projecting_bays; ++i) {
    for (const Part& part : bay) {
      parts.push_back({part.name, turned(part.mesh, plan.arched_bay(i))});
    }
  }
}

void add_dome_ribs(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const Meridian meridian(t);
  const double from = 0.02, to = meridian.angle() - 0.004, relief = t.rib_relief;
  // Flat band between two rounded shoulders.
  const Polyline2 section{{-1.0, -0.15},          {1.0, -0.15},         {1.0, 0.45 * relief},
                          {0.78, 0.80 * relief},  {0.55, relief},       {-0.55, relief},
                          {-0.78, 0.80 * relief}, {-1.0, 0.45 * relief}};
  const double wide = 0.5 * t.rib_width, narrow = 0.42 * wide;
  const Mesh rib = on_meridian(plan, from, to, section,
                               [&](double share) { return wide + (narrow - wide) * share; });
  const double r = t.lead_roll_radius;
  const Polyline2 round{{-1.0, -0.08},  {1.0, -0.08},    {1.0, 0.3 * r},
                        {0.6, 0.9 * r}, {-0.6, 0.9 * r}, {-1.0, 0.3 * r}};
  const Mesh roll = on_meridian(plan, from, 0.86 * to, round, [&](double) { return r; });
  // Too thin for a coarse model.
  const int rolls = plan.fineness.shows(2.0 * r) ? t.lead_rolls_between_ribs : 0;
  for (int i = 0; i < t.dome_ribs; ++i) {
    const double step = 2.0 * pi / t.dome_ribs, azimuth = i * step;
    parts.push_back({"dome rib", turned(rib, azimuth)});
    for (int j = 1; j <= rolls; ++j) {
      parts.push_back({"lead roll", turned(roll, azimuth + step * j / (rolls + 1))});
    }
  }
}

void add_lantern_order(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const double foot = t.lantern_foot() + 0.34, top = t.cap_foot() - 0.30, r = t.lantern_radius;
  const Mesh shaft = box({r - 0.15, -0.15, foot}, {r + 0.16, 0.15, top});
  const Mesh base = box({r - 0.15, -0.20, foot}, {r + 0.22, 0.20, foot + 0.22});
  const Mesh capital = box({r - 0.15, -0.20, top - 0.22}, {r + 0.22, 0.20, top - 0.04});
  for (int i = 0; i < t.lantern_openings; ++i) {
    const double azimuth = 2.0 * pi * (i + 0.5) / t.lantern_openings;
    parts.push_back({"lantern pilaster", turned(shaft, azimuth)});
    parts.push_back({"lantern pilaster base", turned(base, azimuth)});
    parts.push_back({"lantern pilaster capital", turned(capital, azimuth)});
  }
}

}  // namespace skycap::sim::models::radcliffe
