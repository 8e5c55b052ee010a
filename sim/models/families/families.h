/// Families of scenes that expose weaknesses of planners: hollow, thin, tall, narrow or glassy
/// structures. Each is generated from a seed with sizes within stated ranges. It stands on z = 0
/// around the origin and is at most 65 m long and 55 m high. Properties that hold by construction
/// are part of the result.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/random_numbers.h"
#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

using geometry::RandomNumbers;

/// Scene of a family: closed solids and their known properties.
struct FamilyScene {
  Parts parts;
  /// Boxes of enclosed rooms without access or visibility from outside. Walls, floors and ceilings
  /// lie on these boxes.
  std::vector<Eigen::AlignedBox3d> sealed_rooms = {};
  /// Rooms, decks and passages that a ball of 0.8 m can enter from outside.
  std::vector<Eigen::AlignedBox3d> open_rooms = {};
};

struct Family {
  std::string_view name;
  FamilyScene (*make)(RandomNumbers& draw, const Fineness& fineness);
};

/// Returns the families in alphabetical order:
///   bridge: three to five arches on piers, with parapets;
///   church: nave, aisles between buttresses, apse, a tower below a spire;
///   factory: saw-tooth hall, slender chimneys up to 48 m, a pipe rack, tanks;
///   fences: thin walls, railings, poles with wires;
///   garage: four or five open parking decks, a stair tower;
///   glass-house: an office block behind panes without returns, and mirrors;
///   grove: a house among trees close to its walls;
///   hillside: houses on a slope that is part of the surface;
///   hollow-house: a house with an open hall and sealed rooms;
///   lattice-tower: a braced steel tower of 36 to 48 m;
///   old-town: houses on lanes of 2.6 to 4 m, one lane below a house;
///   statue: a figure with raised arm and staff on a plinth.
std::span<const Family> families();

FamilyScene bridge(RandomNumbers& draw, const Fineness& fineness);
FamilyScene church(RandomNumbers& draw, const Fineness& fineness);
FamilyScene factory(RandomNumbers& draw, const Fineness& fineness);
FamilyScene fences(RandomNumbers& draw, const Fineness& fineness);
FamilyScene garage(RandomNumbers& draw, const Fineness& fineness);
FamilyScene glass_house(RandomNumbers& draw, const Fineness& fineness);
FamilyScene grove(RandomNumbers& draw, const Fineness& fineness);
FamilyScene hillside(RandomNumbers& draw, const Fineness& fineness);
FamilyScene hollow_house(RandomNumbers& draw, const Fineness& fineness);
FamilyScene lattice_tower(RandomNumbers& draw, const Fineness& fineness);
FamilyScene old_town(RandomNumbers& draw, const Fineness& fineness);
FamilyScene statue(RandomNumbers& draw, const Fineness& fineness);

}  // namespace skycap::sim::models
