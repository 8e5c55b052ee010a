/// Trees as coarse solids.
#pragma once

#include "sim/models/masonry/draw.h"
#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

/// A tree of that height: a trunk and a lumpy crown.
Parts tree(double height, Draw& draw, const Fineness& fineness);

}  // namespace skycap::sim::models
