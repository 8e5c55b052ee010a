/// The planner that a mission names.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "missions/config/mission.h"
#include "survey/planner.h"

namespace skycap::missions::config {

/// The planner that the mission names, on so many threads (zero: all processors). Throws
/// Error{bad_config} if it is volumetric and the mission does not say where its sphere is.
std::unique_ptr<survey::Planner> make_planner(const config::Mission& mission, unsigned threads);

/// Throws Error{bad_config}, "SETTING is ...; it must be ...", for the first setting that the named
/// planner cannot work with. What only other planners use is not looked at; where the sphere of a
/// volumetric planner follows from the scene, it is taken to be fine.
void validate_planner(const config::Mission& mission);

/// What a view costs the planner skycap besides the way to it, as metres of way, by planner.goal;
/// nothing if that is the planner's own price.
std::optional<double> view_price_of(const config::Mission& mission);

/// The most views of a survey: the mission's, and for volumetric planners V if that is less.
std::size_t view_limit(const config::Mission& mission);

}  // namespace skycap::missions::config
