/// Basic elements of buildings.
#pragma once

#include <Eigen/Core>

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

/// Returns a round bar between two points.
geometry::Mesh bar(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius,
                   const Fineness& fineness);

/// Returns a box on a ground plan around (x, y), from z = low to high.
geometry::Mesh block(double x, double y, double width, double depth, double low, double high);

/// Returns a gabled roof with gables at +x and -x, on walls of the given size that end at z =
/// `foot`. It overhangs by `eaves` along y and by `verge` along x.
geometry::Mesh gabled_roof(double width, double depth, double foot, double slope,
                           double eaves = 0.5, double verge = 0.3);

/// Returns a rectangle around the z axis, counter-clockwise from above.
Polyline3 level_rectangle(double width, double depth, double z);

/// Returns an upright cylinder or frustum on the z axis.
geometry::Mesh frustum(double foot_radius, double top_radius, double low, double high,
                       const Fineness& fineness);

}  // namespace skycap::sim::models
