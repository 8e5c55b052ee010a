#include <skycap/missions/evaluation.h>

#include "example.h"

// Evaluates points on a roof: they cover it and have no distance from it.
const Example evaluation_example("missions/evaluation", [] {
  const skycap::geometry::Mesh roof{{{0, 0, 9}, {8, 0, 9}, {8, 6, 9}, {0, 6, 9}},
                                    {{0, 1, 2}, {0, 2, 3}}};
  const auto cloud = skycap::geometry::sample_surface(roof, 50'000, 1).points;
  const auto found = skycap::missions::library::evaluate(cloud, roof, {.distance = 0.2});
  return found.coverage > 0.99 && found.largest < 1e-5 && found.area == 48.0;
});
