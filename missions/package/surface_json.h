/// JSON objects of summary.json for the coverage of targets and for missing surface.
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "missions/package/holes.h"
#include "missions/package/target_coverage.h"

namespace skycap::missions::package {

/// Returns the missing surface as JSON. `known_by` is the source of the surface: "planner" or
/// "simulator".
nlohmann::ordered_json missing_json(const MissingSurface& missing, const char* known_by);

/// Returns the coverage of each target object, divided by kind of surface.
nlohmann::ordered_json targets_json(const std::vector<TargetCoverage>& targets);

}  // namespace skycap::missions::package
