/// Steps of resolve() that handle prior data.
#pragma once

#include "missions/config/resolve.h"

namespace skycap::missions::config {

/// Makes the paths of prior data absolute, because a package stores the mission in another folder.
void make_sources_absolute(MissionDocument& document);

/// Checks that ground truth from prior data contains surfaces and that no key transforms it. Throws
/// Error{bad_config}.
void check_truth(const MissionDocument& document);

}  // namespace skycap::missions::config
