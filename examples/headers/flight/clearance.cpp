#include <cmath>

#include <skycap/flight/clearance.h>
#include <skycap/flight/obstacles.h>

#include "example.h"

// A leg 7 m from a tower is verified. A leg that crosses its roof at 1 m is not.
const Example clearance_example("flight/clearance", [] {
  const skycap::flight::Prism tower{"tower", {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, 0.0, 30.0};
  const skycap::flight::KnownSpace space({.mesh = skycap::flight::surface(tower)});
  const auto beside = verify(space, {{-20, -12, 10}, {20, -12, 10}}, 2.0);
  const auto over = verify(space, {{-20, 0, 31}, {20, 0, 31}}, 2.0);
  return beside.is_verified && std::abs(beside.clearance - 7.0) < 1e-3 && !over.is_verified &&
         std::abs(over.closest.distance - 1.0) < 1e-3;
});
