/// Coverage of targets and what is missing of a surface, as summary.json has them.
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "missions/package/holes.h"
#include "missions/package/target_coverage.h"

namespace skycap::missions::package {

/// `known_by` is "planner" or "simulator": whose pieces of surface they are.
nlohmann::ordered_json missing_json(const MissingSurface& missing, const char* known_by);

/// By object of the targets, and by kind of surface.
nlohmann::ordered_json targets_json(const std::vector<TargetCoverage>& targets);

}  // namespace skycap::missions::package
