// Families of monuments: a church, a statue, an office block behind glass.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/models/families/families.h"
#include "sim/models/masonry/elements.h"

namespace skycap::sim::models {
namespace {

using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;

/// Returns a stepped buttress, 0.8 m wide, against a wall with its face at y = 0 on the +y side.
Mesh buttress(double reach, double height) {
  const Polyline2 outline{{-reach, 0.0},
                          {0.1, 0.0},
                          {0.1, height},
                          {-0.3 * reach, height - 0.8},
                          {-0.3 * reach, 0.6 * height},
                          {-reach, 0.6 * height - 0.9}};
  return extrude(outline, -0.4, 0.4);
}

/// Adds nave and aisles along x, with buttresses and pinnacles between the bays of the aisles.
void add_nave(double length, double nave, double aisle, double eaves, int bays, Parts& parts) {
  const double low = 0.55 * eaves;
  parts.push_back({"nave", block(0.0, 0.0, length, nave, 0.0, eaves)});
  parts.push_back({"nave roof", gabled_roof(length, nave, eaves, 1.2)});
  for (const double side : {1.0, -1.0}) {
    const double inner = 0.5 * nave - 0.1, outer = 0.5 * nave + aisle;
    const Mesh body =
        extrude({{inner, 0.0}, {outer, 0.0}, {outer, low}, {inner, low + 0.5 * aisle}},
                -0.5 * length + 0.2, 0.5 * length - 0.2);
    // Buttresses are created for the wall towards -y and rotated by 180 degrees for the other side.
    parts.push_back({"aisle", side > 0.0 ? body : turned(body, pi)});
    for (int i = 0; i <= bays; ++i) {
      const double x = (length - 2.0) * (static_cast<double>(i) / bays - 0.5);
      const Mesh one = moved(buttress(1.5, low + 0.6), {side * x, -outer, 0.0});
      parts.push_back({"buttress", side > 0.0 ? turned(one, pi) : one});
      const Mesh pinnacle =
          loft({level_rectangle(0.6, 0.6, 0.6 * low - 1.0), level_rectangle(0.6, 0.6, low + 1.2),
                level_rectangle(0.05, 0.05, low + 2.8)});
      parts.push_back({"pinnacle", moved(pinnacle, {x, side * (outer + 0.35), 0.0})});
    }
  }
}

}  // namespace

FamilyScene church(RandomNumbers& draw, const Fineness& fineness) {
  FamilyScene scene;
  Parts& parts = scene.parts;
  const double length = draw.between(22.0, 30.0), nave = draw.between(8.0, 10.0);
  const double aisle = draw.between(3.0, 4.0), eaves = draw.between(9.0, 12.0);
  add_nave(length, nave, aisle, eaves, draw.integer(4, 6), parts);
  const double apse = 0.45 * nave;
  const Mesh round = revolve({{0.0, 0.0},
                              {apse, 0.0},
                              {apse, 0.8 * eaves},
                              {apse + 0.3, 0.8 * eaves},
                              {0.0, 0.8 * eaves + apse}},
                             std::max(10, fineness.circle(apse)));
  parts.push_back({"apse", moved(round, {0.5 * length, 0.0, 0.0})});
  const double side = draw.between(6.0, 7.5), top = draw.between(20.0, 26.0);
  const double spire = draw.between(12.0, 18.0), x = -0.5 * length - 0.5 * side + 0.3;
  parts.push_back({"tower", block(x, 0.0, side, side, 0.0, top)});
  parts.push_back({"belfry cornice", block(x, 0.0, side + 0.7, side + 0.7, top - 0.6, top)});
  const Mesh pyramid = loft(
      {level_rectangle(0.9 * side, 0.9 * side, top), level_rectangle(0.06, 0.06, top + spire)});
  parts.push_back({"spire", moved(pyramid, {x, 0.0, 0.0})});
  for (int i = 0; i < 4; ++i) {
    const double dx = i % 2 == 0 ? -1.0 : 1.0, dy = i / 2 == 0 ? -1.0 : 1.0;
    const double at = 0.5 * side - 0.2;
    const Mesh corner =
        loft({level_rectangle(0.8, 0.8, top - 0.2), level_rectangle(0.8, 0.8, top + 1.6),
              level_rectangle(0.05, 0.05, top + 3.6)});
    parts.push_back({"pinnacle", moved(corner, {x + dx * at, dy * at, 0.0})});
    // Blind openings of the belfry, recessed behind a frame of two jambs and a head.
    parts.push_back(
        {"jamb", block(x + dx * 1.2, dy * (0.5 * side + 0.1), 0.3, 0.3, top - 6.0, top - 1.0)});
  }
  return scene;
}

FamilyScene statue(RandomNumbers& draw, const Fineness& fineness) {
  FamilyScene scene;
  Parts& parts = scene.parts;
  const double plinth = draw.between(3.0, 5.0), side = draw.between(4.0, 5.5);
  for (int i = 0; i < 3; ++i) {
    const double step = side + 1.2 * (3 - i);
    parts.push_back({"step", block(0.0, 0.0, step, step, 0.3 * i, 0.3 * (i + 1))});
  }
  parts.push_back({"plinth", block(0.0, 0.0, side, side, 0.9, plinth)});
  parts.push_back({"cornice", block(0.0, 0.0, side + 0.6, side + 0.6, plinth - 0.5, plinth - 0.2)});

  // Figure, s times the size of a person: robe, torso and head, one raised arm, one arm with a
  // staff.
  const double s = draw.between(3.6, 5.0), turn = draw.between(0.0, 2.0 * pi);
  const int chords = std::max(16, fineness.circle(0.3 * s));
  Parts figure;
  figure.push_back(
      {"robe",
       revolve(
           {{0.0, 0.0}, {0.34 * s, 0.0}, {0.27 * s, 0.45 * s}, {0.17 * s, 1.0 * s}, {0.0, 1.0 * s}},
           chords)});
  figure.push_back({"torso", loft({level_rectangle(0.32 * s, 0.2 * s, 0.95 * s),
                                   level_rectangle(0.5 * s, 0.26 * s, 1.4 * s),
                                   level_rectangle(0.2 * s, 0.16 * s, 1.5 * s)})});
  figure.push_back(
      {"head",
       moved(revolve(Profile(fineness, 0.0, 0.0).arc_to(0.0, 0.28 * s, pi).points(), chords),
             {0.0, 0.0, 1.47 * s})});
  const Vector3d left(-0.24 * s, 0.0, 1.38 * s), right(0.24 * s, 0.0, 1.38 * s);
  const Vector3d elbow(-0.42 * s, -0.12 * s, 1.5 * s), hand(-0.4 * s, -0.2 * s, 1.85 * s);
  figure.push_back({"arm", bar(left, elbow, 0.06 * s, fineness)});
  figure.push_back({"arm", bar(elbow, hand, 0.05 * s, fineness)});
  const Vector3d grip(0.5 * s, -0.25 * s, 1.15 * s);
  figure.push_back({"arm", bar(right, grip, 0.06 * s, fineness)});
  figure.push_back(
      {"staff", bar({grip.x(), grip.y(), 0.0}, {grip.x(), grip.y(), 2.1 * s}, 0.02 * s, fineness)});
  for (Part& part : figure) {
    parts.push_back({std::move(part.name),
                     moved(turned(std::move(part.mesh), turn), {0.0, 0.0, plinth - 0.05})});
  }
  return scene;
}

FamilyScene glass_house(RandomNumbers& draw, const Fineness&) {
  FamilyScene scene;
  Parts& parts = scene.parts;
  const int bays = draw.integer(5, 7), floors = draw.integer(4, 6);
  const double bay = draw.between(2.4, 3.2), storey = draw.between(3.2, 3.8);
  const double side = bays * bay, half = 0.5 * side, pane = 0.06;
  const int mirrored = draw.integer(0, 3);  // Mirrored front.
  for (int level = 0; level <= floors; ++level) {
    const double z = level * storey;
    parts.push_back({"slab", block(0.0, 0.0, side, side, z, z + 0.3)});
    if (level == floors) break;
    for (int front = 0; front < 4; ++front) {
      const double azimuth = 0.5 * pi * front;
      for (int i = 0; i < bays; ++i) {
        const double y = -half + (i + 0.5) * bay;
        const Mesh glass = block(half - 0.3, y, pane, bay, z + 0.3, z + storey);
        const Mesh mullion = block(half - 0.15, y - 0.5 * bay + 0.1, 0.3, 0.2, z + 0.3, z + storey);
        parts.push_back({front == mirrored ? "mirror" : "pane", turned(glass, azimuth),
                         front == mirrored ? Surface::mirror : Surface::glass});
        parts.push_back({"mullion", turned(mullion, azimuth)});
      }
    }
  }
  const double top = floors * storey + 0.3;
  parts.push_back({"core", block(0.0, 0.0, 0.4 * side, 0.4 * side, top, top + 3.0)});
  parts.push_back({"plant", block(0.3 * side, 0.3 * side, 2.0, 3.0, top, top + 1.5)});
  // There are no measurements behind the panes: sealed rooms from slab to slab.
  for (int level = 0; level < floors; ++level) {
    const double inner = half - 0.3 - 0.5 * pane, z = level * storey;
    scene.sealed_rooms.emplace_back(Vector3d(-inner, -inner, z + 0.3),
                                    Vector3d(inner, inner, z + storey));
  }
  return scene;
}

}  // namespace skycap::sim::models
