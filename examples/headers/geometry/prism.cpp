#include <skycap/geometry/prism.h>

#include "example.h"

// Tests points inside a vertical volume, above it and next to it.
const Example prism_example("geometry/prism", [] {
  const skycap::geometry::Prism yard{"yard", {{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0.0, 30.0};
  return contains(yard, {5, 5, 12}) && !contains(yard, {5, 5, 31}) && !contains(yard, {5, 11, 12});
});
