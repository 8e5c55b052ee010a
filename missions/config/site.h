/// Where a mission lets the sensor be: what its `site` and `limits` say, in one place for planners,
/// start views and the evaluation.
#pragma once

#include <optional>

#include "geometry/place/pose.h"
#include "missions/config/mission.h"
#include "survey/view_limits.h"

namespace skycap::missions::config {

/// The least z of a view that limits.ground_clearance allows; nothing without it.
std::optional<double> least_view_height(const config::Mission& mission);

/// The limits of mission.site, mission.limits and the vehicle together, heights as z in the
/// mission's frame.
survey::ViewLimits view_limits(const config::Mission& mission);

/// From how far planners look at a surface: planner.view_distance, else where the sensor's pixels
/// are as dense as planner.density wants points.
double view_distance_of(const config::Mission& mission);

/// The view that the mission has a survey begin with; nothing if it leaves that open.
std::optional<geometry::View> given_start(const config::Mission& mission);

}  // namespace skycap::missions::config
