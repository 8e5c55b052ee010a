/// What a route must keep away from, as plain data: surfaces, measured points, no-fly volumes, the
/// geofence, the ground.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/prism.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight {

class PriorObstacle;
using geometry::Prism;

/// Points that stand for the surface around them: each is a ball.
struct PointObstacles {
  std::vector<Eigen::Vector3f> points;
  double radius = 0.0;  ///< at least the distance from any surface point to the nearest of them
};

/// Everything known in advance. Any part may be missing.
struct Obstacles {
  geometry::Mesh mesh;
  bool mesh_is_solid = true;  ///< being inside the mesh is as bad as touching it
  PointObstacles cloud;
  std::vector<Prism> no_fly;
  std::optional<Prism> fence;           ///< the vehicle must stay inside
  std::optional<double> ground_height;  ///< everything below is solid
  std::vector<std::shared_ptr<const PriorObstacle>> priors;
};

/// Throws Error{bad_geometry} or Error{bad_config} on the first part that cannot be worked with: a
/// mesh with bad indices or coordinates, a point that is not finite, a footprint with fewer than
/// three corners, without area or crossing itself, a floor that is not below its ceiling, a fence
/// that lies wholly below the ground.
void validate(const Obstacles& obstacles);

/// What a climb from a pad has to keep clear of: everything but the ground, which priors may be
/// (PriorObstacle::is_ground()), and the fence's floor.
Obstacles without_ground(Obstacles obstacles);

/// The prism's closed surface, facing outward. An infinite floor or ceiling becomes -/+ 100 km.
geometry::Mesh surface(const Prism& prism);

}  // namespace skycap::flight
