/// Ray packets for tests.
#pragma once

#include <Eigen/Core>

#include "sim/scene/scene_trees.h"

namespace skycap::sim {

/// Puts a ray into a lane. Origin and direction are in the world frame.
inline void aim(RayPacket& packet, int lane, const Scene& scene, const Eigen::Vector3d& origin,
                const Eigen::Vector3d& towards) {
  const Eigen::Vector3f local = (origin - scene.trees().centre).cast<float>();
  for (int axis = 0; axis < 3; ++axis) {
    packet.origin[axis][lane] = local[axis];
    packet.direction[axis][lane] = static_cast<float>(towards[axis]);
  }
}

}  // namespace skycap::sim
