/// Rays in packets, for tests of every packet's width.
#pragma once

#include <Eigen/Core>

#include "sim/scene/scene_embree.h"

namespace skycap::sim {

/// Puts a ray into a lane; origin and direction are in the scene's frame.
template <int width>
void aim(Packet<width>& packet, int lane, const Scene& scene, const Eigen::Vector3d& origin,
         const Eigen::Vector3d& towards) {
  const Eigen::Vector3f local = (origin - scene.embree().centre).cast<float>();
  const Eigen::Vector3f direction = towards.cast<float>();
  packet.rays.ray.org_x[lane] = local.x();
  packet.rays.ray.org_y[lane] = local.y();
  packet.rays.ray.org_z[lane] = local.z();
  packet.rays.ray.dir_x[lane] = direction.x();
  packet.rays.ray.dir_y[lane] = direction.y();
  packet.rays.ray.dir_z[lane] = direction.z();
}

}  // namespace skycap::sim
