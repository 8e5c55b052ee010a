/// Solids over flat outlines: what maps know of buildings.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

/// Adds the solid between an outline with holes (rings as in geometry::add_polygon) and the same
/// at another height: `top[i]` is above `bottom[i]`. Floor, roof and walls face outwards. False if
/// the outline has no area; nothing is added then.
bool add_extruded(Object& object, std::span<const Eigen::Vector3d> bottom,
                  std::span<const Eigen::Vector3d> top, std::span<const std::uint32_t> begin);

}  // namespace skycap::missions::site_data
