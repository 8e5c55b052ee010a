/// Sample points on the visible surface of an object.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

/// Points as a structure of arrays.
struct SurfacePoints {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  ///< Outward normals where the object is closed.
  std::vector<SurfaceKind> kinds;
  double area_per_point = 0.0;
};

/// Samples the object at random with uniform density: about one point per square of side `spacing`
/// [m], at most `max` points. The result is deterministic. Excluded are surfaces that sensors
/// cannot observe: ground surfaces, horizontal surfaces at the foot of the object, and surfaces
/// with solid on both sides.
SurfacePoints spread_over(const Object& object, std::size_t max, double spacing);

}  // namespace skycap::missions::site_data
