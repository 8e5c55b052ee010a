// Families of engineering structures: a factory, a steel tower, parking decks, a bridge, fences.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/models/families/families.h"
#include "sim/models/masonry/elements.h"

namespace skycap::sim::models {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;

/// Adds a slender chimney at `at`: a shaft with rings, and a flue that is closed just below the
/// rim.
void add_chimney(double radius, double height, const Vector3d& at, const Fineness& fineness,
                 Parts& parts) {
  const double top = 0.72 * radius, flue = top - 0.18;
  const int chords = std::max(12, fineness.circle(radius));
  const Mesh shaft = revolve({{0.0, 0.0},
                              {radius, 0.0},
                              {top, height},
                              {flue, height},
                              {flue, height - 1.0},
                              {0.0, height - 1.0}},
                             chords);
  parts.push_back({"chimney", moved(shaft, at)});
  for (const double share : {0.5, 0.75, 0.97}) {
    const double r = radius + share * (top - radius), z = share * height;
    const Mesh ring = revolve_ring(
        {{r - 0.1, z - 0.15}, {r + 0.25, z - 0.15}, {r + 0.25, z + 0.15}, {r - 0.1, z + 0.15}},
        chords);
    parts.push_back({"chimney ring", moved(ring, at)});
  }
}

/// Adds pipes along x on trestles, in two layers.
void add_pipe_rack(double length, double y, RandomNumbers& draw, const Fineness& fineness,
                   Parts& parts) {
  const double levels[] = {4.2, 6.0}, half = 0.5 * length;
  const int trestles = static_cast<int>(length / 6.0);
  for (int i = 0; i <= trestles; ++i) {
    const double x = -half + length * i / trestles;
    for (const double side : {-1.6, 1.6}) {
      parts.push_back({"trestle", block(x, y + side, 0.25, 0.25, 0.0, levels[1])});
    }
    for (const double level : levels) {
      parts.push_back({"trestle", block(x, y, 0.25, 3.6, level - 0.25, level)});
    }
  }
  for (const double level : levels) {
    double at = -1.4;
    while (at < 1.1) {
      const double radius = draw.between(0.12, 0.32);
      parts.push_back(
          {"pipe", bar({-half - 0.8, y + at + radius, level + radius},
                       {half + 0.8, y + at + radius, level + radius}, radius, fineness)});
      at += 2.0 * radius + draw.between(0.15, 0.35);
    }
  }
}

/// Returns the half width of a lattice tower at a height.
double tower_half(double z, double height, double foot, double top) {
  const double share = 1.0 - z / height;
  return top + (foot - top) * share * share;
}

/// Opening between two piers, along y.
struct Span {
  double from, to;
};

/// Returns `count` centred openings of slightly different widths between piers.
std::vector<Span> draw_spans(int count, double widest, double pier, RandomNumbers& draw) {
  std::vector<Span> spans;
  double y = 0.0;
  for (int i = 0; i < count; ++i) {
    const double from = y + pier;
    y = from + draw.between(0.85, 1.0) * widest;
    spans.push_back({from, y});
  }
  for (Span& span : spans) {
    span.from -= 0.5 * (y + pier);
    span.to -= 0.5 * (y + pier);
  }
  return spans;
}

/// Returns the outline in (y, z) of the part above a bridge's piers: a deck on arches.
Polyline2 arched_outline(const std::vector<Span>& spans, double springing, double deck, double end,
                         const Fineness& fineness) {
  Profile outline(fineness, -end, deck);
  outline.to(-end, springing);
  for (const Span& span : spans) {
    outline.to(span.from, springing).arc_to(span.to, springing, -pi);
  }
  return outline.to(end, springing).to(end, deck).points();
}

}  // namespace

FamilyScene factory(RandomNumbers& draw, const Fineness& fineness) {
  FamilyScene scene;
  Parts& parts = scene.parts;
  const double width = draw.between(24.0, 34.0), eaves = draw.between(7.0, 9.0);
  const int teeth = draw.integer(3, 5);
  const double depth = teeth * draw.between(4.5, 5.5), rise = draw.between(1.8, 2.6);
  Polyline2 outline{{-0.5 * depth, 0.0}, {0.5 * depth, 0.0}};
  for (int i = teeth; i > 0; --i) {  // From +y to -y: vertical glazing with slopes in between.
    const double y = depth * (static_cast<double>(i) / teeth - 0.5);
    outline.emplace_back(y, eaves + rise);
    outline.emplace_back(depth * (static_cast<double>(i - 1) / teeth - 0.5), eaves);
  }
  parts.push_back({"hall", extrude(outline, -0.5 * width, 0.5 * width)});
  const int chimneys = draw.integer(2, 3);
  for (int i = 0; i < chimneys; ++i) {
    const double x = width * ((i + 0.5) / chimneys - 0.5);
    const double radius = draw.between(1.0, 1.5), height = draw.between(30.0, 48.0);
    add_chimney(radius, height, {x, 0.5 * depth + draw.between(4.0, 7.0), 0.0}, fineness, parts);
  }
  const double rack = draw.between(24.0, 34.0), before = draw.between(6.0, 8.0);
  add_pipe_rack(rack, -0.5 * depth - before, draw, fineness, parts);
  const int tanks = draw.integer(1, 2);
  for (int i = 0; i < tanks; ++i) {
    const double radius = draw.between(2.0, 3.0), height = draw.between(5.0, 9.0);
    const Mesh tank = revolve(Profile(fineness, 0.0, 0.0)
                                  .to(radius, 0.0)
                                  .to(radius, height)
                                  .arc_to(0.0, height + 0.35 * radius, 0.4 * pi)
                                  .points(),
                              fineness.circle(radius));
    parts.push_back({"tank", moved(tank, {0.5 * width + 5.0, -7.0 + 9.0 * i, 0.0})});
  }
  return scene;
}

FamilyScene lattice_tower(RandomNumbers& draw, const Fineness& fineness) {
  FamilyScene scene;
  Parts& parts = scene.parts;
  const double height = draw.between(36.0, 48.0), foot = draw.between(4.0, 5.5), top = 0.9;
  const int panels = draw.integer(8, 10);
  const auto corner = [&](int level, int side) {
    // Legs start inside their footings.
    const double z = level == 0 ? 0.4 : height * level / panels;
    const double half = tower_half(z, height, foot, top);
    const double x = side == 0 || side == 3 ? -half : half, y = side < 2 ? -half : half;
    return Vector3d(x, y, z);
  };
  for (int level = 0; level < panels; ++level) {
    for (int side = 0; side < 4; ++side) {
      const int next = (side + 1) % 4;
      parts.push_back({"leg", bar(corner(level, side), corner(level + 1, side), 0.17, fineness)});
      parts.push_back({"brace", bar(corner(level, side), corner(level + 1, next), 0.08, fineness)});
      parts.push_back({"brace", bar(corner(level, next), corner(level + 1, side), 0.08, fineness)});
      parts.push_back(
          {"strut", bar(corner(level + 1, side), corner(level + 1, next), 0.1, fineness)});
    }
  }
  for (const int level : {panels / 2, panels}) {
    const double z = height * level / panels;
    const double side = 2.0 * tower_half(z, height, foot, top) + 1.6;
    parts.push_back({"platform", block(0.0, 0.0, side, side, z, z + 0.15)});
  }
  parts.push_back({"mast", bar({0.0, 0.0, height}, {0.0, 0.0, height + 6.0}, 0.15, fineness)});
  for (int side = 0; side < 4; ++side) {
    const Vector3d at = corner(0, side);
    parts.push_back({"footing", block(at.x(), at.y(), 1.2, 1.2, 0.0, 0.6)});
  }
  return scene;
}

FamilyScene garage(RandomNumbers& draw, const Fineness&) {
  FamilyScene scene;
  Parts& parts = scene.parts;
  const double width = draw.between(26.0, 34.0), depth = draw.between(15.0, 18.0);
  const double storey = draw.between(3.3, 3.6), slab = 0.3, parapet = 0.7;
  const int decks = draw.integer(4, 5);
  const int columns = static_cast<int>(width / 7.0);
  for (int i = 0; i < decks; ++i) {
    const double z = i * storey;  // Upper side of the deck.
    parts.push_back(
        {"deck", block(0.0, 0.0, width, depth, z == 0.0 ? 0.0 : z - slab, z == 0.0 ? 0.1 : z)});
    for (const double side : {-1.0, 1.0}) {
      const double x = side * (0.5 * width - 0.1), y = side * (0.5 * depth - 0.1);
      parts.push_back({"parapet", block(0.0, y, width, 0.2, std::max(z, 0.1), z + parapet)});
      parts.push_back({"parapet", block(x, 0.0, 0.2, depth - 0.4, std::max(z, 0.1), z + parapet)});
    }
    if (i + 1 == decks) break;
    for (int j = 0; j <= columns; ++j) {
      const double x = (width - 1.0) * (static_cast<double>(j) / columns - 0.5);
      for (const double y : {-0.5 * depth + 0.5, 0.0, 0.5 * depth - 0.5}) {
        parts.push_back({"column", block(x, y, 0.45, 0.45, std::max(z, 0.1), z + storey - slab)});
      }
    }
    scene.open_rooms.emplace_back(Vector3d(-0.5 * width, -0.5 * depth, std::max(z, 0.1)),
                                  Vector3d(0.5 * width, 0.5 * depth, z + storey - slab));
  }
  parts.push_back({"stair tower", block(0.5 * width + 2.2, draw.between(-4.0, 4.0), 4.4, 5.0, 0.0,
                                        decks * storey + 1.5)});
  return scene;
}

FamilyScene bridge(RandomNumbers& draw, const Fineness& fineness) {
  FamilyScene scene;
  const int arches = draw.integer(3, 5);
  const double span = draw.between(8.5, 48.0 / arches - 1.0), pier = draw.between(1.6, 2.4);
  const double springing = draw.between(2.5, 5.0), width = draw.between(6.0, 9.0);
  const double crown = springing + 0.5 * span, deck = crown + draw.between(0.9, 1.4);
  const std::vector<Span> spans = draw_spans(arches, span, pier, draw);
  const double end = spans.back().to + pier, half = 0.5 * width;
  Parts& parts = scene.parts;
  const Polyline2 outline = arched_outline(spans, springing, deck, end, fineness);
  parts.push_back({"bridge", extrude(outline, -half, half)});
  for (int i = 0; i <= arches; ++i) {
    const double y = i == arches ? end - 0.5 * pier : spans[i].from - 0.5 * pier;
    parts.push_back({"pier", block(0.0, y, width, pier, 0.0, springing + 0.05)});
    for (const double side : {-1.0, 1.0}) {
      const Mesh cutwater = block(side * half, y, 1.6, 0.7 * pier, 0.0, springing - 0.4);
      parts.push_back({"cutwater", cutwater});
    }
  }
  for (const double side : {-1.0, 1.0}) {
    const double x = side * (half - 0.2);
    parts.push_back({"parapet", block(x, 0.0, 0.4, 2.0 * end, deck, deck + 1.0)});
    parts.push_back({"coping", block(x, 0.0, 0.6, 2.0 * end, deck + 1.0, deck + 1.15)});
  }
  for (const auto& [from, to] : spans) {
    scene.open_rooms.emplace_back(Vector3d(-half, from, 0.0), Vector3d(half, to, springing));
  }
  return scene;
}

FamilyScene fences(RandomNumbers& draw, const Fineness& fineness) {
  FamilyScene scene;
  Parts& parts = scene.parts;
  const int walls = draw.integer(3, 4);
  for (int i = 0; i < walls; ++i) {
    const double length = draw.between(8.0, 14.0), height = draw.between(2.5, 4.5);
    const double thickness = draw.between(0.08, 0.15), azimuth = draw.between(0.0, pi);
    const Vector3d at(-18.0 + 12.0 * i, draw.between(-6.0, 6.0), 0.0);
    const Mesh wall = block(0.0, 0.0, length, thickness, 0.0, height);
    parts.push_back({"thin wall", moved(turned(wall, azimuth), at)});
  }
  const double y = draw.between(11.0, 14.0);  // One railing along x, and one along y.
  for (const bool is_along_x : {true, false}) {
    const auto add_vertex = [&](double along, double z) {
      return is_along_x ? Vector3d(along, y, z) : Vector3d(-26.0, along, z);
    };
    const double half = is_along_x ? 20.0 : 10.0;
    for (double at = -half; at <= half + 1e-9; at += 2.0) {
      parts.push_back({"post", bar(add_vertex(at, 0.0), add_vertex(at, 1.15), 0.03, fineness)});
    }
    for (const double z : {0.4, 0.75, 1.1}) {
      parts.push_back(
          {"rail", bar(add_vertex(-half - 0.1, z), add_vertex(half + 0.1, z), 0.025, fineness)});
    }
  }
  const double line = -draw.between(11.0, 14.0), pole = draw.between(6.5, 8.0);
  constexpr int poles = 4;
  for (int i = 0; i < poles; ++i) {
    const double x = -24.0 + 16.0 * i;
    parts.push_back({"pole", moved(frustum(0.16, 0.11, 0.0, pole, fineness), {x, line, 0.0})});
    parts.push_back({"arm", block(x, line, 0.15, 1.8, pole - 0.6, pole - 0.45)});
    if (i == 0) continue;
    for (const double side : {-0.8, 0.0, 0.8}) {  // Two straight halves of a sagging wire.
      const Vector3d from(x - 16.0, line + side, pole - 0.4), to(x, line + side, pole - 0.4);
      const Vector3d middle = 0.5 * (from + to) - Vector3d(0.0, 0.0, 0.5);
      parts.push_back({"wire", bar(from, middle, 0.012, fineness)});
      parts.push_back({"wire", bar(middle, to, 0.012, fineness)});
    }
  }
  return scene;
}

}  // namespace skycap::sim::models
