/// Steps of resolve() that handle prior data.
#pragma once

#include "missions/config/resolve.h"

namespace skycap::missions::config {

/// Makes the paths of prior data absolute, because a package stores the mission in another folder.
void make_sources_absolute(MissionDocument& document);

/// Returns the outline of the mission's pattern, extruded between its base and its top, as prior
/// data with the role target. It is the ground truth if the mission has no other prior data and
/// uses targets as ground truth. Returns null otherwise.
std::shared_ptr<const site_data::SitePriors> make_outline_priors(const MissionDocument& document);

/// Checks that ground truth from prior data contains surfaces and that no key transforms it. Throws
/// Error{bad_config}.
void check_truth(const MissionDocument& document);

}  // namespace skycap::missions::config
