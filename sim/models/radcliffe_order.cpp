#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "sim/models/masonry/corinthian.h"
#include "sim/models/masonry/mouldings.h"
#include "sim/models/radcliffe_elements.h"

namespace skycap::sim::models::radcliffe {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;

/// Returns x of a round wall's face at y = `half_width`, where a flat frame must still intersect
/// it.
double wall_face_x(double radius, double half_width) {
  return std::sqrt(radius * radius - half_width * half_width);
}

void add_turned(const Parts& elements, double azimuth, Parts& parts) {
  for (const Part& part : elements) parts.push_back({part.name, turned(part.mesh, azimuth)});
}

/// Returns a festoon of cloth and fruit between two points in (y, z), with the depth `sag`. It is
/// thickest in the middle.
Mesh swag(const Vector2d& from, const Vector2d& to, double sag, double thickness, double x,
          const Fineness& fineness) {
  const int subdivisions = 4 * std::clamp(fineness.chords(0.5 * (to - from).norm(), pi), 2, 12);
  const int chords = fineness.circle(thickness);
  std::vector<Polyline3> rings;
  for (int i = 0; i <= subdivisions; ++i) {
    const double share = static_cast<double>(i) / subdivisions, across = 2.0 * share - 1.0;
    const Vector2d chord = to - from;
    const Vector2d at = from + share * chord - Vector2d(0.0, sag * (1.0 - across * across));
    const Vector2d ahead = (chord + Vector2d(0.0, 4.0 * sag * across)).normalized();
    // The lumps represent leaves and fruit.
    const double lumps = 1.0 + 0.13 * std::cos(14.0 * pi * share);
    const double radius = thickness * (0.45 + 0.55 * (1.0 - across * across)) * lumps;
    Polyline3& ring = rings.emplace_back();
    for (int j = 0; j < chords; ++j) {
      const double angle = 2.0 * pi * j / chords;
      ring.emplace_back(x + radius * std::cos(angle), at.x() - radius * std::sin(angle) * ahead.y(),
                        at.y() + radius * std::sin(angle) * ahead.x());
    }
  }
  return loft(rings);
}

/// Returns a modillion: a bracket below the corona with a scroll at its outer end, as a profile in
/// (x, z) along y.
Mesh modillion(double back, double reach, double top, double height, double width,
               const Fineness& fineness) {
  Profile profile(fineness, back, top);
  profile.to(back, top - height)
      .by(0.12, 0.0)
      .arc_to(reach - 0.16, top - 0.62 * height, 0.35 * pi)
      .arc_to(reach, top - 0.35 * height, 0.9 * pi)
      .to(reach, top);
  return turned(extrude(profile.points(), -0.5 * width, 0.5 * width), -0.5 * pi);
}

}  // namespace

void add_columns(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  // Parts inside the wall are omitted: the axis is only slightly in front of its face.
  const Column column{t.column_height, t.column_radius, t.column_radius_at_top,
                      plan.has_fluted_columns ? t.flutes : 0, 0.72 * pi};
  Parts elements = corinthian_column(column, plan.fineness);
  for (Part& part : elements) {
    part.mesh = moved(std::move(part.mesh), {t.column_axis_radius, 0.0, t.column_foot()});
  }
  for (const double azimuth : plan.columns()) add_turned(elements, azimuth, parts);
}

void add_window_frames(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const double foot = t.column_foot();
  Frame window;
  window.half_width = 0.5 * t.window_width;
  window.sill = foot + t.window_sill;
  window.head = window.sill + t.window_height;
  window.face = t.wall_radius;
  window.back = wall_face_x(t.wall_radius, window.half_width + 0.6) - 0.08;
  window.band = 0.24;
  window.lug = 0.0;

  Pediment pediment;
  pediment.half_width = window.half_width + window.band + 0.02;
  pediment.level = window.head + window.band + 0.22;
  pediment.rise = 0.52;
  pediment.back = window.back;
  pediment.front = t.wall_radius + 0.12;
  pediment.overhang = 0.20;
  pediment.cornice_height = 0.20;
  const Mesh frieze =
      box({window.back, -pediment.half_width + 0.03, window.head + window.band - 0.05},
          {pediment.front - 0.03, pediment.half_width - 0.03, pediment.level + 0.05});

  Frame mezzanine = window;
  mezzanine.half_width = 0.5 * t.mezzanine_width;
  mezzanine.sill = foot + t.mezzanine_sill;
  mezzanine.head = mezzanine.sill + t.mezzanine_height;
  mezzanine.band = 0.20;
  mezzanine.lug = 0.14;

  const double panel = t.wall_radius - t.window_reveal;
  for (int i = 0; i < t.projecting_bays; ++i) {
    Parts bay;
    add_frame("window", window, plan.fineness, bay);
    bay.push_back({"window frieze", frieze});
    pediment.is_segmental = i % 2 == 1;
    add_pediment("window pediment", pediment, plan.fineness, bay);
    add_frame("mezzanine", mezzanine, plan.fineness, bay);
    add_glazing_bars("window bar", window.half_width, window.sill, window.head, panel, 4, 8,
                     plan.fineness, bay);
    add_glazing_bars("mezzanine bar", mezzanine.half_width, mezzanine.sill, mezzanine.head, panel,
                     4, 3, plan.fineness, bay);
    add_turned(bay, plan.arched_bay(i), parts);
  }
}

void add_niche_frames(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const double foot = t.column_foot();
  Frame frame;
  frame.half_width = 0.5 * t.niche_width;
  frame.face = t.wall_radius;
  frame.back = wall_face_x(t.wall_radius, frame.half_width + 0.5) - 0.08;
  frame.band = 0.18;
  frame.lug = 0.0;
  Parts bay;
  const auto add_tier = [&](const char* name, double sill, double height) {
    frame.sill = foot + sill;
    frame.head = frame.sill + height;
    add_arched_frame(name, frame, plan.fineness, bay);
    const double reach = frame.half_width + frame.band + 0.08;
    bay.push_back(
        {std::string(name) + " sill", box({frame.back, -reach, frame.sill - 0.16},
                                          {t.wall_radius + 0.18, reach, frame.sill - 0.005})});
    const double springing = frame.head - frame.half_width;
    for (const double side : {-1.0, 1.0}) {
      const double middle = side * (frame.half_width + 0.5 * frame.band);
      bay.push_back({std::string(name) + " impost",
                     box({frame.back, middle - 0.16, springing - 0.12},
                         {t.wall_radius + 0.15, middle + 0.16, springing + 0.04})});
    }
    bay.push_back({std::string(name) + " keystone", extrude({{-0.11, frame.head - 0.06},
                                                             {0.11, frame.head - 0.06},
                                                             {0.16, frame.head + 0.34},
                                                             {-0.16, frame.head + 0.34}},
                                                            frame.back, t.wall_radius + 0.19)});
  };
  add_tier("lower niche", t.lower_niche_sill, t.lower_niche_height);
  add_tier("upper niche", t.upper_niche_sill, t.upper_niche_height);
  // Moulded panel above the lower niche, between the tiers.
  const double panel_sill = foot + t.lower_niche_sill + t.lower_niche_height + 0.55;
  bay.push_back({"niche panel", box({frame.back, -0.72, panel_sill},
                                    {t.wall_radius + 0.06, 0.72, panel_sill + 0.5})});
  for (int i = 0; i < t.projecting_bays; ++i) add_turned(bay, plan.niche_bay(i), parts);
}

void add_festoons(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const double level = t.entablature_foot() - 0.35, x = t.wall_radius + 0.02;
  Parts bay;
  constexpr double half = 0.92;
  bay.push_back({"festoon", swag({-half, level}, {half, level}, 0.55, 0.15, x, plan.fineness)});
  for (const double side : {-half, half}) {
    bay.push_back({"festoon drop", swag({side, level + 0.12}, {side + 1e-3, level - 0.95}, 0.0,
                                        0.10, x - 0.02, plan.fineness)});
    Profile knot(plan.fineness, 0.0, -0.3);
    knot.to(0.13, -0.3).to(0.13, 0.02).arc_to(0.0, 0.11, 0.4 * pi);
    Mesh rosette = revolve(knot.points(), plan.fineness.circle(0.13));
    transform(rosette, Eigen::Affine3d(Eigen::Translation3d(x + 0.03, side, level + 0.1)) *
                           Eigen::AngleAxisd(0.5 * pi, Vector3d::UnitY()));
    bay.push_back({"festoon rosette", rosette});
  }
  for (int i = 0; i < t.projecting_bays; ++i) add_turned(bay, plan.niche_bay(i), parts);
}

void add_cornice_blocks(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const double top = t.balustrade_foot(), face = t.column_axis_radius + t.column_radius_at_top;
  const int bays = 2 * t.projecting_bays;
  // Heights as in the profile of the entablature.
  const Mesh dentil = box({face, -0.065, top - 0.79}, {face + 0.17, 0.065, top - 0.63});
  const Mesh bracket = modillion(face + 0.15, face + t.cornice_overhang - 0.20, top - 0.29, 0.22,
                                 0.30, plan.fineness);
  const int dentils = bays * t.dentils_in_a_bay, brackets = bays * t.modillions_in_a_bay;
  for (int i = 0; i < dentils && plan.fineness.shows(0.13); ++i) {
    parts.push_back({"dentil", turned(dentil, 2.0 * pi * i / dentils)});
  }
  for (int i = 0; i < brackets; ++i) {
    parts.push_back({"modillion", turned(bracket, 2.0 * pi * (i + 0.5) / brackets)});
  }
}

}  // namespace skycap::sim::models::radcliffe
