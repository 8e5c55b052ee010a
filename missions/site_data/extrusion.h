/// Extrusion of flat building outlines to solids.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

/// Adds the solid between an outline with holes and the same outline at another height. Rings are
/// as in geometry::add_polygon(), and `top[i]` is above `bottom[i]`. Floor, roof and walls face
/// outwards. Returns false and adds nothing if the outline has zero area.
bool add_extruded(Object& object, std::span<const Eigen::Vector3d> bottom,
                  std::span<const Eigen::Vector3d> top, std::span<const std::uint32_t> begin);

}  // namespace skycap::missions::site_data
