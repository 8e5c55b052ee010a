/// Glass and mirrors in sensor measurements. Internal to sim.
#pragma once

#include <cstdint>

#include "sim/scene/ray_kernels.h"
#include "sim/scene/scene_trees.h"

namespace skycap::sim {

/// Casts the lanes of a packet like RayKernels::cast, with the effects of surfaces. Rays that meet
/// glass have no hit. Rays that meet a mirror hit the mirrored object at the distance of the total
/// path. The normal is mirrored back, so that its angle to the emitted ray equals the true angle of
/// incidence. A ray is lost after eight mirrors.
void cast_at_surfaces(const Scene::Trees& trees, RayPacket& packet, std::uint32_t lanes,
                      float reach);

}  // namespace skycap::sim
