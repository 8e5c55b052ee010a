/// Corinthian column: Attic base, shaft with entasis, capital with two tiers of acanthus leaves,
/// corner volutes and a concave abacus. Proportions: Gibbs, Rules for Drawing the Several Parts of
/// Architecture (1732), in modules of the foot diameter.
#pragma once

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

struct Column {
  double height;
  double foot_radius;
  double top_radius;
  int flutes;       ///< Number of flutes. 0: plain shaft.
  double exposure;  ///< Leaves and volutes farther than this from azimuth 0 are omitted [rad].
};

/// Returns the column's closed solids, with the z axis as axis, the foot at z = 0 and the front at
/// azimuth 0.
Parts corinthian_column(const Column& column, const Fineness& fineness);

}  // namespace skycap::sim::models
