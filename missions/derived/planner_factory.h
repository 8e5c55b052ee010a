/// The planner that a mission names.
#pragma once

#include <cstddef>
#include <memory>

#include "missions/file/mission.h"
#include "survey/planner.h"

namespace skycap::missions::derived {

/// The planner that the mission names, on so many threads (zero: all processors). Throws
/// Error{bad_config} if it is volumetric and the mission does not say where its sphere is.
std::unique_ptr<survey::Planner> make_planner(const file::Mission& mission, unsigned threads);

/// The most views of a survey: the mission's, and for volumetric planners V if that is less.
std::size_t view_limit(const file::Mission& mission);

}  // namespace skycap::missions::derived
