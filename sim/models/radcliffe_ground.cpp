#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/models/masonry/mouldings.h"
#include "sim/models/radcliffe_elements.h"

namespace skycap::sim::models::radcliffe {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

/// Returns true for the projecting bay with the entrance, at azimuth 90 degrees (north).
bool is_north(const Plan& plan, int bay) { return bay == plan.table.projecting_bays / 4; }

/// Returns a bar along the line from `a` to `b` on the glazing, in (y, z).
geometry::Mesh bar(const Vector2d& a, const Vector2d& b, double half_width, double back,
                   double front) {
  const Vector2d side = half_width * Vector2d(a.y() - b.y(), b.x() - a.x()).normalized();
  return extrude({a - side, b - side, b + side, a + side}, back, front);
}

}  // namespace

void add_pediments(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  Pediment pediment;
  pediment.half_width = 0.5 * t.projection_width;
  pediment.level = t.pediment_level() - 0.02;
  pediment.rise = t.ground_pediment_rise;
  pediment.back = t.ground_wall_radius - 1.0;
  pediment.front = t.projection_front;
  pediment.overhang = 0.42;
  pediment.cornice_height = 0.40;
  pediment.is_segmental = false;
  Parts one;
  add_pediment("ground pediment", pediment, plan.fineness, one);
  for (int i = 0; i < t.projecting_bays; ++i) {
    for (const Part& part : one) {
      parts.push_back({part.name, turned(part.mesh, plan.arched_bay(i))});
    }
  }
}

void add_keystones(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const auto wedge = [&](double crown, double springing, double height, double back, double front) {
    // The sides point to the centre of the arch.
    const double half_angle = 0.75 * pi / t.arch_voussoirs;
    const auto at = [&](double radius, double side) {
      const double z = springing + radius * std::cos(half_angle);
      return Vector2d(side * radius * std::sin(half_angle), z);
    };
    const double inner = crown - springing - 0.04, outer = crown - springing + height;
    return extrude({at(inner, -1.0), at(inner, 1.0), at(outer, 1.0), at(outer, -1.0)}, back, front);
  };
  const double arch_springing = t.arch_crown - 0.5 * t.arch_width;
  const geometry::Mesh arch =
      wedge(t.arch_crown, arch_springing, t.pediment_level() - t.arch_crown + 0.06,
            t.projection_front - 0.3, t.projection_front + 0.16);
  const double niche_springing = t.ground_niche_crown - 0.5 * t.ground_niche_width;
  const geometry::Mesh niche =
      wedge(t.ground_niche_crown, niche_springing, t.ground_niche_voussoir_height,
            t.ground_wall_radius - 0.3, t.ground_wall_radius + 0.12);
  for (int i = 0; i < t.projecting_bays; ++i) {
    parts.push_back({"arch keystone", turned(arch, plan.arched_bay(i))});
    parts.push_back({"niche keystone", turned(niche, plan.niche_bay(i))});
  }
}

void add_arch_glazing(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const double face = t.projection_front - t.arch_depth;
  const double radius = 0.5 * t.arch_width, springing = t.arch_crown - radius;
  const double back = face - 0.15, front = face + 0.08;
  if (!plan.fineness.shows(0.07)) return;
  for (int i = 0; i < t.projecting_bays; ++i) {
    const double sill =
        t.base_course_height + (is_north(plan, i) ? 2.0 * t.course_height : 0.0) - 0.03;
    const auto add = [&](const Vector2d& a, const Vector2d& b, double half_width) {
      parts.push_back(
          {"arch glazing bar", turned(bar(a, b, half_width, back, front), plan.arched_bay(i))});
    };
    constexpr int lights = 4;
    for (int j = 1; j < lights; ++j) {
      const double y = radius * (2.0 * j / lights - 1.0);
      add({y, sill}, {y, springing}, j == lights / 2 ? 0.07 : 0.04);
    }
    for (double z = sill + 0.9; z < springing - 0.3; z += 0.75) {
      add({-radius - 0.02, z}, {radius + 0.02, z}, 0.035);
    }
    add({-radius - 0.02, springing}, {radius + 0.02, springing}, 0.08);
    // Fanlight: rays from the middle of the impost, and a half ring.
    constexpr int rays = 6;
    for (int j = 1; j < rays; ++j) {
      const double angle = pi * j / rays;
      const Vector2d direction(std::cos(angle), std::sin(angle));
      const Vector2d centre(0.0, springing);
      add(centre + 0.42 * direction, centre + (radius + 0.02) * direction, 0.035);
    }
    Polyline2 ring = Profile(plan.fineness, 0.46, springing - 0.02)
                         .arc_to(-0.46, springing - 0.02, pi)
                         .to(-0.36, springing - 0.02)
                         .arc_to(0.36, springing - 0.02, -pi)
                         .points();
    parts.push_back(
        {"arch fanlight ring", turned(extrude(ring, back, front + 0.01), plan.arched_bay(i))});
  }
}

void add_north_steps(const Plan& plan, Parts& parts) {
  const RadcliffeTable& t = plan.table;
  const double landing = t.step_count * t.step_rise, front = t.projection_front;
  const double foot = front + 0.9 + (t.step_count - 1) * t.step_tread;
  // From the ground up to the landing in front of the door, in (x, z).
  Polyline2 profile{{front - 0.3, 0.0}, {foot, 0.0}};
  for (int i = 1; i <= t.step_count; ++i) {
    profile.emplace_back(profile.back().x(), i * t.step_rise);
    profile.emplace_back(i < t.step_count ? foot - i * t.step_tread : front - 0.3, i * t.step_rise);
  }
  const auto along_y = [&](const Polyline2& outline, double from, double to) {
    return turned(extrude(outline, from, to), -0.5 * pi);
  };
  const double half = 0.5 * t.step_width, azimuth = plan.arched_bay(t.projecting_bays / 4);
  parts.push_back({"north steps", turned(along_y(profile, -half, half), azimuth)});
  // Flanking walls along the steps, with a pedestal at the foot.
  for (const double side : {-1.0, 1.0}) {
    const double inner = half - 0.08, outer = half + 0.42;
    const double from = side > 0.0 ? inner : -outer, to = side > 0.0 ? outer : -inner;
    const Polyline2 wall{{front - 0.3, 0.0},
                         {foot + 0.2, 0.0},
                         {foot + 0.2, 0.55},
                         {front + 0.9, landing + 0.35},
                         {front - 0.3, landing + 0.35}};
    parts.push_back({"step wall", turned(along_y(wall, from, to), azimuth)});
    parts.push_back({"step pedestal", turned(box({foot - 0.25, side * (half + 0.17) - 0.34, 0.0},
                                                 {foot + 0.43, side * (half + 0.17) + 0.34, 0.95}),
                                             azimuth)});
  }
}

}  // namespace skycap::sim::models::radcliffe
