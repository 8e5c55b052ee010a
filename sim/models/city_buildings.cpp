#include "sim/models/city_buildings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/models/masonry/elements.h"
#include "sim/models/masonry/tower.h"
#include "sim/models/masonry/wall.h"

namespace skycap::sim::models::city {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;

/// Common properties of a building's windows.
struct Facade {
  double storey;  ///< Storey height [m].
  double window_width, window_height;
  double spacing;  ///< Minimum distance between window axes [m].
  double reveal;
};

Facade draw_facade(geometry::RandomNumbers& draw) {
  Facade facade;
  facade.storey = draw.between(3.2, 4.2);
  facade.window_width = draw.between(1.0, 1.6);
  facade.window_height = draw.between(1.5, 2.2);
  facade.spacing = facade.window_width + draw.between(1.2, 2.2);
  facade.reveal = draw.between(0.18, 0.35);
  return facade;
}

/// Returns a box of complete storeys with rows of windows. There are no windows within `margin` of
/// the corners.
Mesh storeys(double width, double depth, double foot, int count, const Facade& facade,
             double margin) {
  const PlanCurve plan = PlanCurve::rectangle(width, depth);
  Wall wall{plan, foot, foot + count * facade.storey, {}, {}};
  double start = 0.0;
  for (const double length : {depth, width, depth, width}) {
    std::vector<Opening> openings;
    const double available_length = length - 2.0 * margin;
    const int windows = static_cast<int>(std::max(0.0, available_length) / facade.spacing);
    for (int i = 0; i < windows; ++i) {
      const double centre = start + margin + available_length * (i + 0.5) / windows;
      for (int storey = 0; storey < count; ++storey) {
        const double sill = foot + storey * facade.storey + 0.28 * facade.storey;
        openings.push_back(rectangular(centre, facade.window_width, sill,
                                       sill + facade.window_height, facade.reveal));
      }
    }
    const std::vector<Polyline2> tiles =
        plain_tiles(start, start + length, wall.bottom, wall.top, openings, length);
    wall.tiles.insert(wall.tiles.end(), tiles.begin(), tiles.end());
    wall.openings.insert(wall.openings.end(), openings.begin(), openings.end());
    start += length;
  }
  return Tower(wall.bottom).add(build(wall)).close(wall.top);
}

/// Returns a roof with eaves, hipped on all sides, on walls of the given size that end at z =
/// `foot`.
Mesh hipped_roof(double width, double depth, double foot, double slope) {
  const double eaves = 0.5, run = 0.5 * std::min(width, depth) + eaves - 0.15;
  const double w = width + 2.0 * eaves, d = depth + 2.0 * eaves;
  return loft({level_rectangle(w, d, foot - 0.25), level_rectangle(w, d, foot),
               level_rectangle(w - 2.0 * run, d - 2.0 * run, foot + slope * run)});
}

/// Returns a parapet around a flat roof at z = `foot`. Also used for string courses and cornices.
Mesh rim(double width, double depth, double foot, double height, double reach) {
  const Polyline2 section{{-0.35, -0.2}, {reach, -0.2}, {reach, height}, {-0.35, height}};
  Polyline3 path = level_rectangle(width, depth, foot);
  std::reverse(path.begin(), path.end());  // Outwards is to the left of the path.
  return sweep(section, path, Vector3d::UnitZ(), true);
}

/// Adds chimneys along the ridge above the line y = `axis`.
void add_chimneys(double width, double axis, double foot, double ridge,
                  geometry::RandomNumbers& draw, Parts& parts) {
  const int count = draw.integer(1, 3);
  for (int i = 0; i < count; ++i) {
    const double x = width * ((i + 0.5) / count - 0.5) + draw.between(-0.8, 0.8);
    const double y = axis + draw.between(-1.2, 1.2), top = ridge + draw.between(0.8, 1.6);
    parts.push_back({"chimney", block(x, y, 1.3, 0.7, foot, top)});
    parts.push_back({"chimney", block(x, y, 1.5, 0.9, top - 0.35, top - 0.12)});
    for (const double side : {-0.33, 0.33}) {
      const Mesh pot =
          revolve({{0.0, top - 0.1}, {0.17, top - 0.1}, {0.13, top + 0.5}, {0.0, top + 0.5}}, 8);
      parts.push_back({"chimney", moved(pot, {x + side, y, 0.0})});
    }
  }
}

/// Adds dormers to the slope towards -y of a roof that rises with `slope` from (y = -half, z =
/// foot).
void add_dormers(double width, double half, double foot, double slope, Parts& parts) {
  const int count = static_cast<int>(width / 6.0);
  for (int i = 0; i < count; ++i) {
    const double x = width * ((i + 0.5) / count - 0.5), front = -half + 1.2;
    const double sill = foot + 0.4 * slope, top = sill + 1.9;
    const double back = std::min(-0.2, -half + (top - foot) / slope + 0.8);
    const Polyline2 outline{
        {x - 0.8, sill}, {x + 0.8, sill}, {x + 0.8, top - 0.5}, {x, top}, {x - 0.8, top - 0.5}};
    // extrude() works along x. After a rotation by -90 degrees, the first axis of the outline would
    // be along -y.
    Polyline2 mirrored;
    for (const Vector2d& p : outline) mirrored.emplace_back(-p.x(), p.y());
    // After a rotation by +90 degrees, x becomes y and the outline runs along -x.
    parts.push_back({"dormer", turned(extrude(mirrored, front, back), 0.5 * pi)});
  }
}

/// Adds a wing or a complete house body with its roof.
void add_wing(double width, double depth, int count, const Facade& facade, double margin,
              bool is_hipped, double slope, const Vector3d& at, double azimuth, Parts& parts) {
  const auto add = [&](const char* name, Mesh mesh) {
    parts.push_back({name, moved(turned(std::move(mesh), azimuth), at)});
  };
  const double eaves = count * facade.storey;
  add("walls", storeys(width, depth, 0.0, count, facade, margin));
  add("string course", rim(width, depth, facade.storey, 0.05, 0.12));
  add("roof", is_hipped ? hipped_roof(width, depth, eaves, slope)
                        : gabled_roof(width, depth, eaves, slope));
}

}  // namespace

Parts town_house(const Lot& lot, geometry::RandomNumbers& draw, const Fineness&) {
  const Facade facade = draw_facade(draw);
  const double width = lot.width - draw.between(1.0, 5.0);
  const double depth = std::min(lot.depth, draw.between(12.0, 16.0));
  const int count = draw.integer(2, 5);
  const bool is_hipped = draw.integer(0, 1) == 0;
  const double slope = draw.between(0.7, 1.1);
  const double front = -0.5 * (lot.depth - depth);  // At the street.
  Parts parts;
  add_wing(width, depth, count, facade, 1.2, is_hipped, slope, {0.0, 0.0, 0.0}, 0.0, parts);
  const double eaves = count * facade.storey, half = 0.5 * depth + 0.5;
  add_chimneys(0.7 * width, 0.0, eaves, eaves + slope * half, draw, parts);
  if (draw.integer(0, 1) == 0) {
    const double available_length = is_hipped ? width - depth : width - 2.0;
    add_dormers(std::max(0.0, available_length), half, eaves, slope, parts);
  }
  if (draw.integer(0, 1) == 0) {  // Lower wing at the back.
    const double wing = std::min(lot.depth - depth, draw.between(8.0, 14.0));
    if (wing > 4.0) {
      const double x = (draw.integer(0, 1) == 0 ? -1.0 : 1.0) * (0.5 * width - 4.5);
      add_wing(wing + 1.5, 8.0, std::max(1, count - 1), facade, 2.2, false, slope,
               {x, 0.5 * depth + 0.5 * wing - 0.75, 0.0}, 0.5 * pi, parts);
    }
  }
  for (Part& part : parts) part.mesh = moved(std::move(part.mesh), {0.0, front, 0.0});
  return parts;
}

Parts office(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness) {
  const Facade facade = draw_facade(draw);
  Parts parts;
  double width = lot.width - draw.between(1.0, 4.0), depth = std::min(lot.depth, 30.0);
  double foot = 0.0;
  const int steps = draw.integer(1, 3);
  for (int i = 0; i < steps; ++i) {
    const int count = draw.integer(2, 4);
    // Each step starts inside the one below, where its floor is hidden.
    const double overlap = i == 0 ? 0.0 : 0.3;
    parts.push_back({"walls", storeys(width, depth, foot - overlap, count, facade, 1.0)});
    foot += count * facade.storey - overlap;
    parts.push_back({"parapet", rim(width, depth, foot, 0.9, 0.15)});
    if (i + 1 < steps) {
      width -= draw.between(4.0, 7.0);
      depth -= draw.between(4.0, 7.0);
    }
  }
  const int machines = draw.integer(2, 4);
  for (int i = 0; i < machines; ++i) {
    const double x = width * ((i + 0.5) / machines - 0.5), y = draw.between(-0.2, 0.2) * depth;
    const double height = draw.between(1.2, 3.0);
    if (draw.integer(0, 2) == 0) {
      const double r = 0.9;
      const Mesh tank = revolve(Profile(fineness, 0.0, foot - 0.1)
                                    .to(r, foot - 0.1)
                                    .to(r, foot + height)
                                    .arc_to(0.0, foot + height + 0.4, 0.4 * pi)
                                    .points(),
                                fineness.circle(r));
      parts.push_back({"tank", moved(tank, {x, y, 0.0})});
    } else {
      const double along_y = draw.between(2.0, 4.0), along_x = draw.between(2.0, 4.0);
      parts.push_back({"plant", block(x, y, along_x, along_y, foot - 0.1, foot + height)});
    }
  }
  return parts;
}

Parts courtyard_house(const Lot& lot, geometry::RandomNumbers& draw, const Fineness&) {
  const Facade facade = draw_facade(draw);
  const double wing = std::min(draw.between(9.0, 11.0), 0.28 * std::min(lot.width, lot.depth));
  const double width = lot.width - 2.0, depth = lot.depth - 2.0;
  const int count = draw.integer(3, 4);
  const double slope = draw.between(0.6, 0.9);
  Parts parts;
  for (const double side : {-1.0, 1.0}) {
    // Front and back wings have full width. The side wings end inside them.
    add_wing(width, wing, count, facade, 1.4, true, slope, {0.0, side * 0.5 * (depth - wing), 0.0},
             0.0, parts);
    add_wing(depth - 2.0 * wing + 3.0, wing - 0.6, count - 1, facade, 2.8, false, slope,
             {side * 0.5 * (width - wing), 0.0, 0.0}, 0.5 * pi, parts);
  }
  add_chimneys(0.8 * width, -0.5 * (depth - wing), count * facade.storey,
               count * facade.storey + 0.55 * slope * wing, draw, parts);
  return parts;
}

Parts arcade_house(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness) {
  Parts parts;
  Facade facade = draw_facade(draw);
  facade.storey = 3.8;
  const double width = lot.width - 2.0, depth = 14.0, walk = 3.6;
  const double house_front = -0.5 * lot.depth + walk;
  const int count = 3;
  add_wing(width, depth, count, facade, 1.5, true, 0.75, {0.0, house_front + 0.5 * depth, 0.0}, 0.0,
           parts);

  // Arches on piers in front of the house, and a terrace above the walk.
  const int bays = std::max(3, static_cast<int>(width / 4.2));
  const double bay = width / bays, pier = 0.9, radius = 0.5 * (bay - pier);
  const double springing = 2.6, top = springing + radius + 0.7;
  const double front = house_front - walk, back = front + 0.7;
  const auto facing_front = [&](Mesh mesh) { return turned(std::move(mesh), -0.5 * pi); };
  // Created at azimuth 0, where x points out of the wall: x = -y of the block.
  for (int i = 0; i <= bays; ++i) {
    const double y = -0.5 * width + i * bay;
    parts.push_back(
        {"arcade pier", facing_front(box({-back - 0.08, y - 0.5 * pier, 0.0},
                                         {-front + 0.08, y + 0.5 * pier, springing + 0.1}))});
    parts.push_back(
        {"arcade impost", facing_front(box({-back - 0.16, y - 0.5 * pier - 0.1, springing - 0.25},
                                           {-front + 0.16, y + 0.5 * pier + 0.1, springing}))});
  }
  Profile outline(fineness, -0.5 * width - 0.5 * pier, top);
  outline.by(0.0, springing - top);
  for (int i = 0; i < bays; ++i) {
    const double left = -0.5 * width + i * bay + 0.5 * pier;
    outline.to(left, springing).arc_to(left + 2.0 * radius, springing, -pi);
  }
  outline.to(0.5 * width + 0.5 * pier, springing).to(0.5 * width + 0.5 * pier, top);
  parts.push_back({"arcade wall", facing_front(extrude(outline.points(), -back, -front))});
  parts.push_back({"terrace", box({-0.5 * width - 0.6, front - 0.15, top - 0.15},
                                  {0.5 * width + 0.6, house_front + 0.3, top + 0.15})});
  parts.push_back({"terrace wall", box({-0.5 * width - 0.5, front - 0.05, top + 0.05},
                                       {0.5 * width + 0.5, front + 0.25, top + 1.05})});
  return parts;
}

Parts tower_hall(const Lot& lot, geometry::RandomNumbers& draw, const Fineness&) {
  Parts parts;
  const Facade facade = draw_facade(draw);
  const double width = lot.width - 3.0, depth = std::min(lot.depth - 2.0, 16.0);
  const double front = -0.5 * lot.depth + 0.5 * depth + 2.0;
  add_wing(width, depth, 2, facade, 1.4, false, 1.0, {0.0, front, 0.0}, 0.0, parts);

  // Half of the tower projects from the front of the hall.
  const double side = draw.between(8.0, 9.5);
  const int count = draw.integer(7, 9);
  const double top = count * facade.storey, spire = draw.between(9.0, 14.0);
  const Vector3d at(0.25 * width * (draw.integer(0, 1) == 0 ? -1.0 : 1.0),
                    front - 0.5 * depth + 0.5 * side - 1.2, 0.0);
  const auto add = [&](const char* name, Mesh mesh) {
    parts.push_back({name, moved(std::move(mesh), at)});
  };
  add("tower walls", storeys(side, side, 0.0, count, facade, 1.3));
  for (int i = 2; i < count; i += 2) {
    add("tower string course", rim(side, side, i * facade.storey, 0.1, 0.18));
  }
  add("tower cornice", rim(side, side, top, 0.8, 0.45));
  // Octagonal lantern stage with the spire.
  const auto octagon = [&](double radius, double z) {
    Polyline3 ring;
    for (int i = 0; i < 8; ++i) {
      const double angle = pi / 8.0 + pi / 4.0 * i;
      ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    return ring;
  };
  const double r = 0.42 * side;
  add("tower lantern", loft({octagon(r, top - 0.2), octagon(r, top + 4.0)}));
  add("tower spire", loft({octagon(1.12 * r, top + 3.8), octagon(1.12 * r, top + 4.2),
                           octagon(0.05, top + 4.2 + spire)}));
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const double corner = 0.5 * side - 0.3;
      add("tower pinnacle",
          loft({level_rectangle(1.0, 1.0, top + 0.5), level_rectangle(1.0, 1.0, top + 1.8),
                level_rectangle(0.06, 0.06, top + 3.6)}));
      parts.back().mesh = moved(std::move(parts.back().mesh), {x * corner, y * corner, 0.0});
    }
  }
  return parts;
}

}  // namespace skycap::sim::models::city
