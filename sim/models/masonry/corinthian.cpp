#include "sim/models/masonry/corinthian.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace skycap::sim::models {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;

/// Adds a square plinth and two tori with a scotia between them.
void add_base(const Column& column, const Fineness& fineness, Parts& parts) {
  const double r = column.foot_radius, half = 1.39 * r;
  parts.push_back({"column plinth", box({-half, -half, -0.03}, {half, half, 0.36 * r})});
  Profile profile(fineness, 0.0, 0.3 * r);
  profile.to(1.26 * r, 0.3 * r)
      .to(1.26 * r, 0.36 * r)
      .arc_by(0.0, 0.26 * r, 0.97 * pi)
      .by(0.0, 0.03 * r)
      .arc_by(-0.12 * r, 0.17 * r, -0.6 * pi)
      .by(0.02 * r, 0.03 * r)
      .arc_by(-0.02 * r, 0.17 * r, 0.95 * pi)
      .by(-0.08 * r, 0.03 * r)
      .to(1.05 * r, 1.06 * r)
      .to(0.0, 1.06 * r);
  parts.push_back({"column base", revolve(profile.points(), fineness.circle(1.3 * r))});
}

/// Returns the radius of the shaft: constant for one third, then decreasing to the top along a
/// curve with a vertical start.
double shaft_radius(const Column& column, double share) {
  const double above = std::max(0.0, (share - 1.0 / 3.0) * 1.5);
  return column.foot_radius -
         (column.foot_radius - column.top_radius) * above * above * (1.5 - 0.5 * above);
}

/// Returns one horizontal section. Flutes are hollows between narrow fillets.
Polyline3 shaft_ring(const Column& column, double radius, double z, bool is_fluted,
                     const Fineness& fineness) {
  Polyline3 ring;
  const auto add = [&](double azimuth, double r) {
    ring.emplace_back(r * std::cos(azimuth), r * std::sin(azimuth), z);
  };
  if (column.flutes == 0) {
    const int chords = fineness.circle(column.foot_radius);
    for (int j = 0; j < chords; ++j) add(2.0 * pi * j / chords, radius);
    return ring;
  }
  const double step = 2.0 * pi / column.flutes, half_flute = 0.39 * step;
  const double depth = column.foot_radius * half_flute;
  const int chords = 2 * fineness.chords(depth, 0.5 * pi);
  for (int flute = 0; flute < column.flutes; ++flute) {
    for (int j = 0; j <= chords; ++j) {
      const double angle = pi * j / chords;
      add(flute * step - half_flute * std::cos(angle),
          radius - (is_fluted ? 0.8 * depth * std::sin(angle) : 0.0));
    }
  }
  return ring;
}

void add_shaft(const Column& column, double capital_foot, const Fineness& fineness, Parts& parts) {
  const double foot = 0.98 * column.foot_radius, length = capital_foot - foot;
  const int subdivisions =
      std::clamp(static_cast<int>(std::lround(0.5 / std::sqrt(fineness.chord_error))), 4, 24);
  std::vector<Polyline3> rings;
  const auto add = [&](double share, bool is_fluted) {
    rings.push_back(shaft_ring(column, shaft_radius(column, share), foot + share * length,
                               is_fluted, fineness));
  };
  if (column.flutes > 0) add(0.0, false);
  add(column.flutes > 0 ? 0.03 : 0.0, false);
  for (int i = 1; i < subdivisions; ++i) add(0.04 + 0.93 * i / subdivisions, true);
  add(column.flutes > 0 ? 0.98 : 1.0, false);
  if (column.flutes > 0) add(1.0, false);
  parts.push_back({"column shaft", loft(rings)});

  const double r = column.top_radius;  // Astragal.
  Profile ring(fineness, 0.8 * r, capital_foot - 0.16 * r);
  ring.by(0.22 * r, 0.0).arc_by(0.0, 0.16 * r, 0.97 * pi).by(-0.22 * r, 0.0);
  parts.push_back({"column astragal", revolve_ring(ring.points(), fineness.circle(r))});
}

/// Dimensions of the capital. Heights are relative to its foot.
struct Capital {
  double foot;         ///< Height z.
  double height;       ///< Including the abacus.
  double abacus;       ///< Height of the abacus.
  double bell_radius;  ///< Radius at the foot.
  double reach;        ///< Extent of the abacus along its diagonals.

  double bell_height() const { return height - abacus; }
  /// Returns the bell radius, which increases towards the lip.
  double bell_radius_at(double share) const {
    return bell_radius * (0.90 + 0.10 * share + 0.26 * std::pow(share, 4.0));
  }
};

void add_bell(const Capital& capital, const Fineness& fineness, Parts& parts) {
  Profile profile(fineness, 0.0, capital.foot - 0.02);
  constexpr int subdivisions = 6;
  for (int i = 0; i <= subdivisions; ++i) {
    const double share = static_cast<double>(i) / subdivisions;
    profile.to(capital.bell_radius_at(share),
               capital.foot - 0.02 + share * (capital.bell_height() + 0.02));
  }
  profile.by(0.0, 0.03).to(0.0, capital.foot + capital.bell_height() + 0.03);
  parts.push_back(
      {"capital bell", revolve(profile.points(), fineness.circle(capital.bell_radius))});
}

/// Returns an acanthus leaf at azimuth 0. It rises along the bell, with a lobed edge and a tip that
/// curls outwards.
Mesh acanthus_leaf(const Capital& capital, double height, double half_width, double lean,
                   const Fineness& fineness) {
  const int along = 2 * std::clamp(fineness.chords(0.25 * height, 1.2 * pi), 2, 36);
  const int across = 2 * fineness.chords(half_width, 0.25 * pi);
  const double curl = 0.13 * height, rise = height - curl, thickness = 0.11 * half_width;
  std::vector<Polyline3> rings;
  for (int i = 0; i <= along; ++i) {
    const double t = static_cast<double>(i) / along;
    // Midrib (distance from the axis, z), and the direction that the leaf faces.
    Vector2d midrib, facing;
    const double upright = 0.72;
    const double foot_radius = capital.bell_radius_at(0.0);
    const auto stem = [&](double share) {
      const double z = share * rise;
      const double follow = capital.bell_radius_at(std::min(1.0, z / capital.bell_height()));
      return Vector2d(std::max(follow, foot_radius) + lean * share * share, capital.foot + z);
    };
    if (t <= upright) {
      midrib = stem(t / upright);
      facing = {1.0, -2.0 * lean / rise * t / upright};
    } else {
      const double angle = (t - upright) / (1.0 - upright) * 0.86 * pi;
      midrib = stem(1.0) + curl * Vector2d(1.0 - std::cos(angle), std::sin(angle));
      facing = {std::cos(angle), -std::sin(angle)};
    }
    facing.normalize();
    const double lobes = 0.80 + 0.20 * std::abs(std::sin(4.5 * pi * t + 0.4));
    const double taper = t < upright ? 0.80 + 0.20 * std::sin(pi * t / upright)
                                     : 0.80 * std::sqrt(std::max(0.02, 1.0 - (t - upright) / 0.30));
    const double width = half_width * lobes * taper;
    // Front with midrib and veins, then the back, a keel against the bell.
    Polyline3& ring = rings.emplace_back();
    const auto add = [&](double v, double out) {
      const double wrap = -0.22 * half_width * v * v;  // The sides bend back around the bell.
      const Vector2d at = midrib + (out + wrap) * facing;
      ring.emplace_back(at.x(), width * v, at.y());
    };
    for (int j = 0; j <= across; ++j) {
      const double v = -1.0 + 2.0 * j / across;
      const double veins = 0.55 + 0.45 * std::cos(3.0 * pi * v);
      add(v, thickness * (0.35 + (1.0 - v * v) * veins));
    }
    add(0.0, -2.0 * thickness);
  }
  return loft(rings);
}

/// Returns a scroll in the vertical plane at azimuth 0: a ribbon that rises from the bell and winds
/// inwards.
Mesh scroll(const Vector2d& from, const Vector2d& eye, double radius, double turns,
            double half_width, double thickness, const Fineness& fineness) {
  Polyline3 path;
  const auto add = [&](const Vector2d& at) { path.emplace_back(at.x(), 0.0, at.y()); };
  // The stem starts vertically and meets the spiral at its top.
  const Vector2d top = eye + Vector2d(0.0, radius);
  const int stem = fineness.chords((top - from).norm(), 0.5 * pi) + 1;
  for (int i = 0; i < stem; ++i) {
    const double angle = 0.5 * pi * i / stem;
    add({from.x() + (top.x() - from.x()) * (1.0 - std::cos(angle)),
         from.y() + (top.y() - from.y()) * std::sin(angle)});
  }
  const double end_radius = 0.30 * radius;
  const int chords =
      std::max(static_cast<int>(5 * turns), fineness.chords(radius, 2.0 * pi * turns));
  for (int i = 0; i <= chords; ++i) {
    const double share = static_cast<double>(i) / chords, angle = 2.0 * pi * turns * share;
    const double r = radius + (end_radius - radius) * share;
    add(eye + r * Vector2d(std::sin(angle), std::cos(angle)));
  }
  const Polyline2 section{{-thickness, -half_width},
                          {thickness, -half_width},
                          {thickness, half_width},
                          {-thickness, half_width}};
  return sweep(section, path, Vector3d::UnitY(), false);
}

/// Returns the abacus: four concave sides between blunt corners, a cavetto below an ovolo.
Mesh abacus(const Capital& capital, const Fineness& fineness) {
  const double half_corner = 0.10 * capital.reach;
  const int chords = 2 * fineness.chords(1.4 * capital.reach, 0.25 * pi);
  std::vector<Polyline3> rings;
  const auto add_ring = [&](double size, double z) {
    Polyline3& ring = rings.emplace_back();
    for (int side = 0; side < 4; ++side) {
      // From the right corner of this side to the left one.
      const Eigen::Rotation2Dd turn(0.5 * pi * side);
      const Vector2d corner = capital.reach * Vector2d(1.0, 1.0) / std::sqrt(2.0);
      const Vector2d blunt = half_corner * Vector2d(1.0, -1.0) / std::sqrt(2.0);
      const Vector2d start(corner.x() + blunt.x(), -(corner.y() + blunt.y()));
      const Vector2d end(corner.x() + blunt.x(), corner.y() + blunt.y());
      for (int j = 0; j <= chords; ++j) {
        const double share = static_cast<double>(j) / chords;
        const double hollow = 0.20 * capital.reach * 4.0 * share * (1.0 - share);
        const Vector2d at = turn * (start + share * (end - start) - Vector2d(hollow, 0.0));
        ring.emplace_back(size * at.x(), size * at.y(), z);
      }
    }
  };
  const double foot = capital.foot + capital.bell_height(), h = capital.abacus;
  Profile profile(fineness, 0.90 * capital.reach, foot);
  profile.to(0.91 * capital.reach, foot + 0.25 * h)
      .to(0.97 * capital.reach, foot + 0.55 * h)
      .by(0.0, 0.07 * h)
      .to(capital.reach, foot + 0.78 * h)
      .to(capital.reach, foot + h + 0.02);  // Into the architrave.
  for (const Vector2d& point : profile.points()) add_ring(point.x() / capital.reach, point.y());
  return loft(rings);
}

void add_capital(const Column& column, const Capital& capital, const Fineness& fineness,
                 Parts& parts) {
  add_bell(capital, fineness, parts);
  parts.push_back({"capital abacus", abacus(capital, fineness)});

  const auto add_all_round = [&](const std::string& name, const Mesh& mesh, int count,
                                 double first) {
    for (int i = 0; i < count; ++i) {
      const double azimuth = std::remainder(first + 2.0 * pi * i / count, 2.0 * pi);
      if (std::abs(azimuth) < column.exposure) parts.push_back({name, turned(mesh, azimuth)});
    }
  };
  const double h = capital.height, r = capital.bell_radius, bell = capital.bell_height();
  add_all_round("acanthus leaf", acanthus_leaf(capital, 0.36 * h, 0.36 * r, 0.10 * r, fineness), 8,
                pi / 8.0);
  add_all_round("acanthus leaf", acanthus_leaf(capital, 0.64 * h, 0.36 * r, 0.12 * r, fineness), 8,
                0.0);

  const double foot = capital.foot, volute = 0.11 * h;
  const Mesh corner = scroll({capital.bell_radius_at(0.5), foot + 0.52 * bell},
                             {0.83 * capital.reach, foot + bell - volute - 0.01}, volute, 1.6,
                             0.13 * r, 0.014 * h, fineness);
  add_all_round("capital volute", corner, 4, 0.25 * pi);
  const double helix = 0.075 * h;
  if (fineness.shows(helix)) {
    const Mesh inner = scroll({capital.bell_radius_at(0.6), foot + 0.60 * bell},
                              {capital.bell_radius_at(1.0) + 0.06 * r, foot + bell - helix - 0.02},
                              helix, 1.3, 0.09 * r, 0.012 * h, fineness);
    for (const double side : {-0.24, 0.24}) {
      add_all_round("capital helix", inner, 4, side);
    }
  }
  if (!fineness.shows(0.2 * r)) return;
  Profile flower(fineness, 0.0, -0.5);
  flower.to(0.20 * r, -0.5).to(0.20 * r, 0.06 * r).arc_to(0.0, 0.16 * r, 0.45 * pi);
  Mesh fleuron = revolve(flower.points(), fineness.circle(0.20 * r));
  transform(fleuron,
            Eigen::Affine3d(Eigen::Translation3d(capital.reach * (1.1 / std::sqrt(2.0) - 0.20), 0.0,
                                                 foot + bell + 0.45 * capital.abacus)) *
                Eigen::AngleAxisd(0.5 * pi, Vector3d::UnitY()));
  add_all_round("capital fleuron", fleuron, 4, 0.0);
}

}  // namespace

Parts corinthian_column(const Column& column, const Fineness& fineness) {
  const double diameter = 2.0 * column.foot_radius;
  Capital capital;
  capital.height = 7.0 / 6.0 * diameter;
  capital.foot = column.height - capital.height;
  capital.abacus = diameter / 6.0;
  capital.bell_radius = column.top_radius;
  capital.reach = 0.90 * diameter;

  Parts parts;
  add_base(column, fineness, parts);
  add_shaft(column, capital.foot, fineness, parts);
  add_capital(column, capital, fineness, parts);
  return parts;
}

}  // namespace skycap::sim::models
