/// Block of city houses, generated from a seed. It tests aerial surveys of streets, courtyards and
/// an arcade.
#pragma once

#include <cstdint>

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

struct CityBlockOptions {
  std::uint64_t seed = 1;
  Fineness fineness{0.004};
};

/// Generates 10 to 16 buildings within 200 m x 200 m around the origin, on z = 0. Rows of fronts,
/// with one arcade and one tower, face a street along x from the north and the south. Behind them
/// are rows of back buildings with at least one courtyard. Trees and pavements are included. All
/// parts are closed solids. The part names of a building start with "building N ", N from 1.
/// Deterministic for a seed.
Parts city_block(const CityBlockOptions& options);

}  // namespace skycap::sim::models
