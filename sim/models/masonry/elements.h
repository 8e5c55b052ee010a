/// What buildings are put together from.
#pragma once

#include <Eigen/Core>

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

/// A round bar from one point to another.
geometry::Mesh bar(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius,
                   const Fineness& fineness);

/// A box on the ground plan round (x, y), from z = low to high.
geometry::Mesh block(double x, double y, double width, double depth, double low, double high);

/// A roof with gables to +x and -x on walls of that size that end at z = `foot`; it hangs over by
/// `eaves` along y and by `verge` along x.
geometry::Mesh gabled_roof(double width, double depth, double foot, double slope,
                           double eaves = 0.5, double verge = 0.3);

/// A rectangle round the z axis, counter-clockwise seen from above.
Polyline3 level_rectangle(double width, double depth, double z);

/// An upright cylinder or frustum on the z axis.
geometry::Mesh frustum(double foot_radius, double top_radius, double low, double high,
                       const Fineness& fineness);

}  // namespace skycap::sim::models
