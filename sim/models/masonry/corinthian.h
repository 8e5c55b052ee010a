/// A Corinthian column: Attic base, shaft with entasis, capital with two tiers of acanthus leaves,
/// corner volutes and a hollowed abacus. Proportions: Gibbs, Rules for Drawing the Several Parts of
/// Architecture (1732), in modules of the diameter at the foot.
#pragma once

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

struct Column {
  double height;
  double foot_radius;
  double top_radius;
  int flutes;       ///< zero: a plain shaft
  double exposure;  ///< leaves and volutes farther than this from azimuth 0 are left out [rad]
};

/// The column's closed solids, its axis the z axis, its foot at z = 0, its front at azimuth 0.
Parts corinthian_column(const Column& column, const Fineness& fineness);

}  // namespace skycap::sim::models
