#include <skycap/geometry/mesh.h>
#include <skycap/geometry/mesh_distance.h>

#include "example.h"

// Computes distances above a roof and next to it, and checks that a path keeps a distance from it.
const Example mesh_distance_example("geometry/mesh_distance", [] {
  const skycap::geometry::Mesh roof{{{0, 0, 9}, {8, 0, 9}, {8, 6, 9}, {0, 6, 9}},
                                    {{0, 1, 2}, {0, 2, 3}}};
  const skycap::geometry::MeshDistance distance(roof);
  return distance.distance({4, 3, 12}) == 3.0 && distance.distance({-4, 3, 12}) == 5.0 &&
         distance.keeps({0, 0, 12}, {8, 6, 12}, 2.9) && !distance.keeps({0, 0, 12}, {8, 6, 8}, 2.0);
});
