/// Points spread over what can be seen of an object.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

/// Structure of arrays.
struct SurfacePoints {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  ///< outward, as far as the object is closed
  std::vector<SurfaceKind> kinds;
  double area_of_each = 0.0;
};

/// At random with equal density, about one in a square of `spacing`, but no more than `most`; the
/// same object gives the same points. What is said to be ground, and what lies level at the foot
/// of the object, is left out, and so is what has solid on both sides: no sensor sees it.
SurfacePoints spread_over(const Object& object, std::size_t most, double spacing);

}  // namespace skycap::missions::site_data
