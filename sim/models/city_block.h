/// A block of city houses, drawn from a seed: a scene for aerial surveys with streets to look into,
/// courtyards to look down into, and an arcade to look under.
#pragma once

#include <cstdint>

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

struct CityBlockOptions {
  std::uint64_t seed = 1;
  Fineness fineness{0.004};
};

/// 10 to 16 buildings within 200 m x 200 m round the origin, on z = 0: a street along x, north and
/// south of it a row of street fronts (one of them over an arcade, one a tower) and behind that a
/// row of backs (at least one round a courtyard); trees, pavements. Closed solids; the names of a
/// building's parts start with "building N ", N from 1. The same seed gives the same block.
Parts city_block(const CityBlockOptions& options);

}  // namespace skycap::sim::models
