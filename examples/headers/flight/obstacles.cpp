#include <skycap/flight/obstacles.h>

#include "example.h"

// Creates a site with a tower as a surface mesh on the ground, and the same site without the
// ground, for the check of a pad.
const Example obstacles_example("flight/obstacles", [] {
  const skycap::flight::Prism tower{"tower", {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, 0.0, 30.0};
  skycap::flight::Obstacles site{.mesh = skycap::flight::surface(tower), .ground_height = 0.0};
  skycap::flight::validate(site);
  return skycap::geometry::surface_area(site.mesh) == 2 * 100.0 + 4 * 300.0 &&
         !without_ground(site).ground_height;
});
