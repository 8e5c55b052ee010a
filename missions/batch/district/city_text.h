/// Writes map objects as a small city model in the district frame. A mission of one target then
/// reads only nearby objects instead of a whole town.
#pragma once

#include <span>
#include <string>

#include "missions/site_data/prior.h"

namespace skycap::missions::batch {

/// Resolution of the coordinates [m]. It must be added to the uncertainty of the written objects.
inline constexpr double city_step = 1e-4;

/// Returns a CityJSON 2.0 model of the objects, ordered by name. Names must be unique. The model
/// has no reference system, because its coordinates are in the frame of the mission.
std::string city_text(std::span<const site_data::Object* const> objects);

}  // namespace skycap::missions::batch
