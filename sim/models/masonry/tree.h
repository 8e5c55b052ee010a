/// Trees as coarse solids.
#pragma once

#include "geometry/random_numbers.h"
#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

using geometry::RandomNumbers;

/// Returns a tree of the given height: a trunk and an irregular crown.
Parts tree(double height, RandomNumbers& draw, const Fineness& fineness);

}  // namespace skycap::sim::models
