#include "sim/models/masonry/mouldings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace skycap::sim::models {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;

/// Returns the section of a cornice, counter-clockwise from its foot at the wall's face to its
/// upper edge. The first coordinate is outwards, the second upwards. It extends `depth` into the
/// wall.
Polyline2 cornice_section(double overhang, double height, double depth, const Fineness& fineness) {
  Profile profile(fineness, -depth, 0.0);
  profile.to(0.12 * overhang, 0.0)
      .by(0.0, 0.16 * height)
      .arc_by(0.22 * overhang, 0.20 * height, -0.5 * pi)
      .to(0.72 * overhang, 0.42 * height)
      .by(0.0, 0.26 * height)
      .wave_by(0.28 * overhang, 0.24 * height, 0.4 * pi)
      .to(overhang, height)
      .to(-depth, height);
  return profile.points();
}

/// Returns the section of an architrave (across its band, out of the wall): two fasciae and an
/// outer fillet.
Polyline2 architrave_section(double band, double back, double face, const Fineness& fineness) {
  Profile profile(fineness, 0.0, back);
  profile.to(0.0, face + 0.05)
      .to(0.40 * band, face + 0.05)
      .by(0.0, 0.025)
      .to(0.72 * band, face + 0.075)
      .wave_by(0.18 * band, 0.045, 0.3 * pi)
      .to(band, face + 0.12)
      .to(band, back);
  Polyline2 section = profile.points();
  std::reverse(section.begin(), section.end());  // Counter-clockwise.
  return section;
}

}  // namespace

void add_pediment(const std::string& name, const Pediment& p, const Fineness& fineness,
                  Parts& parts) {
  // Level cornice along one side, the front and the other side. Outwards is to the left of the
  // path.
  const double inside = std::min(0.3, 0.5 * p.half_width);
  const Polyline3 around{{p.back, p.half_width, p.level},
                         {p.front, p.half_width, p.level},
                         {p.front, -p.half_width, p.level},
                         {p.back, -p.half_width, p.level}};
  parts.push_back(
      {name + " cornice", sweep(cornice_section(p.overhang, p.cornice_height, inside, fineness),
                                around, Vector3d::UnitZ(), false)});

  // Upper edge of the field, from the left end to the right.
  const double eaves = p.level + p.cornice_height, left = -p.half_width;
  Polyline2 edge{{left, eaves}};
  if (p.is_segmental) {
    const double angle = 4.0 * std::atan(p.rise / p.half_width);
    edge = Profile(fineness, left, eaves).arc_to(-left, eaves, -angle).points();
  } else {
    edge.emplace_back(0.0, eaves + p.rise);
    edge.emplace_back(-left, eaves);
  }
  Polyline2 field{{left, p.level + 0.4 * p.cornice_height},
                  {-left, p.level + 0.4 * p.cornice_height}};
  field.insert(field.end(), edge.rbegin(), edge.rend());
  parts.push_back({name + " field", extrude(field, p.back, p.front + 0.02)});

  // Sloping cornices with the roof behind them. They extend beyond the ends of the level cornice.
  const Vector2d first = (edge[1] - edge[0]).normalized() * 1.05 * p.overhang;
  edge.front() -= first;
  edge.back() += Vector2d(first.x(), -first.y());
  Polyline3 path;
  for (const Vector2d& point : edge) path.emplace_back(0.0, point.x(), point.y());
  Polyline2 section;
  for (const Vector2d& point :
       cornice_section(p.overhang, 0.8 * p.cornice_height, p.front - p.back, fineness)) {
    section.emplace_back(point.y() - 0.3 * p.cornice_height, p.front + point.x());
  }
  parts.push_back({name + " slopes", sweep(section, path, Vector3d::UnitX(), false)});
}

void add_frame(const std::string& name, const Frame& f, const Fineness& fineness, Parts& parts) {
  const Polyline2 section = architrave_section(f.band, f.back, f.face, fineness);
  // Up on the left, across the head, down on the right. Outwards is to the left of the path.
  const Polyline3 path{{0.0, -f.half_width, f.sill},
                       {0.0, -f.half_width, f.head},
                       {0.0, f.half_width, f.head},
                       {0.0, f.half_width, f.sill}};
  parts.push_back({name + " architrave", sweep(section, path, Vector3d::UnitX(), false)});
  const double outer = f.half_width + f.band;
  if (f.lug > 0.0) {
    for (const double side : {-1.0, 1.0}) {
      const double from = side * (outer - 0.3 * f.band), to = side * (outer + f.lug);
      const double height = 2.2 * f.band;
      parts.push_back(
          {name + " lug", box({f.back, std::min(from, to), f.head + f.band - height},
                              {f.face + 0.11, std::max(from, to), f.head + f.band - 0.01})});
    }
  }
  // Sill on its two blocks.
  const double reach = outer + std::max(0.06, f.lug);
  Polyline2 profile = cornice_section(0.20, 0.16, f.face - f.back, fineness);
  Polyline2 sill;
  for (const Vector2d& point : profile)
    sill.emplace_back(f.face + point.x(), f.sill - 0.16 + point.y());
  // extrude() works along x; the rotation makes it along y.
  parts.push_back({name + " sill", turned(extrude(sill, -reach, reach), -0.5 * pi)});
  for (const double side : {-1.0, 1.0}) {
    const double middle = side * (f.half_width + 0.5 * f.band);
    parts.push_back({name + " block", box({f.back, middle - 0.4 * f.band, f.sill - 0.42},
                                          {f.face + 0.10, middle + 0.4 * f.band, f.sill - 0.10})});
  }
}

void add_glazing_bars(const std::string& name, double half_width, double sill, double head,
                      double face, int columns, int rows, const Fineness& fineness, Parts& parts) {
  constexpr double half_bar = 0.035;
  if (!fineness.shows(2.0 * half_bar)) return;
  for (int i = 0; i <= columns; ++i) {
    const double y = half_width * (2.0 * i / columns - 1.0);
    parts.push_back({name, box({face - 0.1, y - half_bar, sill - 0.02},
                               {face + 0.07, y + half_bar, head + 0.02})});
  }
  for (int i = 0; i <= rows; ++i) {
    const double z = sill + (head - sill) * i / rows;
    parts.push_back({name, box({face - 0.1, -half_width - 0.02, z - half_bar},
                               {face + 0.06, half_width + 0.02, z + half_bar})});
  }
}

void add_arched_frame(const std::string& name, const Frame& f, const Fineness& fineness,
                      Parts& parts) {
  const double springing = f.head - f.half_width;
  Polyline3 path{{0.0, -f.half_width, f.sill}};
  const int chords = 2 * fineness.chords(f.half_width + f.band, 0.5 * pi);
  for (int i = 0; i <= chords; ++i) {
    const double angle = pi * i / chords;
    path.emplace_back(0.0, -f.half_width * std::cos(angle),
                      springing + f.half_width * std::sin(angle));
  }
  path.emplace_back(0.0, f.half_width, f.sill);
  parts.push_back({name + " architrave", sweep(architrave_section(f.band, f.back, f.face, fineness),
                                               path, Vector3d::UnitX(), false)});
}

}  // namespace skycap::sim::models
