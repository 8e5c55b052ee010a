#include <vector>

#include <skycap/geometry/mesh.h>
#include <skycap/sim/scene.h>
#include <skycap/sim/surface.h>

#include "example.h"

// A glass pane: rays hit it, but sensors get no returns from it.
const Example surface_example("sim/surface", [] {
  const skycap::geometry::Mesh pane{{{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}}, {{0, 1, 2}}};
  const std::vector<skycap::sim::Surface> surfaces{skycap::sim::Surface::glass};
  const std::vector<skycap::sim::ScenePart> parts{{pane, {}, {}, surfaces}};
  const skycap::sim::Scene scene(parts);
  return scene.first_hit({0, 0, 3}, {0, 0, -1}) && scene.surface(0) == skycap::sim::Surface::glass;
});
