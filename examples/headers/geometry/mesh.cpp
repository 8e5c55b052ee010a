#include <skycap/geometry/mesh.h>

#include "example.h"

// Computes the area of a flat roof and samples points on it.
const Example mesh_example("geometry/mesh", [] {
  const skycap::geometry::Mesh roof{{{0, 0, 9}, {8, 0, 9}, {8, 6, 9}, {0, 6, 9}},
                                    {{0, 1, 2}, {0, 2, 3}}};
  skycap::geometry::validate(roof);
  const auto samples = skycap::geometry::sample_surface(roof, 1000, 1);
  const double distance = samples.points[17].z() - 9.0F;
  return skycap::geometry::surface_area(roof) == 48.0 && distance == 0.0;
});
