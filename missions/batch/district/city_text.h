/// Things of maps as a small city model of their own, in the district's frame: so that a mission of
/// one target reads what is near it, and not a whole town.
#pragma once

#include <span>
#include <string>

#include "missions/site_data/prior.h"

namespace skycap::missions::batch {

/// Corners are rounded to this, which whoever reads the file adds to what it may be off [m].
inline constexpr double city_step = 1e-4;

/// CityJSON 2.0 of these, in their order by name, without a reference system: it is in the frame of
/// the mission that names it. Names must differ.
std::string city_text(std::span<const site_data::Object* const> objects);

}  // namespace skycap::missions::batch
