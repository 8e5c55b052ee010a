/// Glass and mirrors: what a sensor measures where its rays meet them. For sources of sim only.
#pragma once

#include <cstdint>

#include "sim/scene/ray_kernels.h"
#include "sim/scene/scene_trees.h"

namespace skycap::sim {

/// Casts the lanes of a packet as RayKernels::cast does and follows them as the scene's surfaces
/// have it: rays that meet glass have no hit, and rays that meet mirrors hit what is mirrored, at
/// the distance of the whole way. Such a hit's normal is mirrored back, so that it stands to the
/// ray as sent as the true one does to the ray as it arrived. After eight mirrors a ray is lost.
void cast_at_surfaces(const Scene::Trees& trees, RayPacket& packet, std::uint32_t lanes,
                      float reach);

}  // namespace skycap::sim
