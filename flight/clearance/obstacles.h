/// Obstacles of a route as plain data: surfaces, measured points, no-fly volumes, geofence and
/// ground.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/prism.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight {

class PriorObstacle;
using geometry::Prism;

/// Balls around points that sample a surface.
struct PointObstacles {
  std::vector<Eigen::Vector3f> points;
  /// Radius of the balls: at least the maximum distance from a surface point to its closest sample
  /// [m].
  double radius = 0.0;
};

/// All obstacles known in advance. Each part is optional.
struct Obstacles {
  geometry::Mesh mesh;
  bool mesh_is_solid = true;  ///< True if the interior of the mesh is an obstacle, too.
  PointObstacles cloud;
  std::vector<Prism> no_fly;
  std::optional<Prism> fence;           ///< Volume that the vehicle must not leave.
  std::optional<double> ground_height;  ///< Height z below which all space is solid [m].
  std::vector<std::shared_ptr<const PriorObstacle>> priors;
};

/// Throws Error{bad_geometry} or Error{bad_config} for the first invalid part. Invalid are meshes
/// with bad indices or coordinates, points that are not finite, floors at or above their ceiling,
/// and fences entirely below the ground. Footprints need at least three corners, a positive area
/// and no self-intersection.
void validate(const Obstacles& obstacles);

/// Returns the obstacles for the climb from a pad: all except the ground, priors that are ground
/// (PriorObstacle::is_ground()) and the floor of the fence.
Obstacles without_ground(Obstacles obstacles);

/// Returns the closed surface of a prism, facing outward. An infinite floor or ceiling becomes -/+
/// 100 km.
geometry::Mesh surface(const Prism& prism);

}  // namespace skycap::flight
