#include <skycap/geometry/mesh.h>
#include <skycap/sim/scene.h>

#include "example.h"

// Finds the first hit of a ray, and tests the line of sight between two positions.
const Example scene_example("sim/scene", [] {
  const skycap::geometry::Mesh floor{{{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}}, {{0, 1, 2}}};
  const skycap::sim::Scene scene(floor);
  const auto hit = scene.first_hit({0, 0, 3}, {0, 0, -1});
  return hit && hit->distance == 3.0 && hit->normal.z() == 1.0 &&
         scene.is_blocked({0, 0, 3}, {0, 0, -1}) && !scene.first_hit({0, 0, 3}, {0, 0, 1});
});
