/// Steps of resolve() that are about prior data.
#pragma once

#include "missions/config/resolve.h"

namespace skycap::missions::config {

/// Makes the paths of prior data absolute: a package holds the mission elsewhere.
void make_sources_absolute(MissionDocument& document);

/// What is truth has to have surfaces, and is where its file says.
void check_truth(const MissionDocument& document);

}  // namespace skycap::missions::config
