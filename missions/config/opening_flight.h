/// What a survey that measures in flight begins with: a way outside of the unknown box, so that
/// nothing has to be known of what is in it; and how fast and how often a laser scanner measures.
#pragma once

#include <vector>

#include "geometry/place/pose.h"
#include "missions/config/mission.h"

namespace skycap::missions::config {

/// Between two scans of a scanner in flight, each of which stands for the turns around it [s].
inline constexpr double scanner_period = 0.5;

/// Round a box, or over it if it is wider than twice its height.
config::Opening usual_opening(const config::Mission& mission);

/// As fast as the scanner's points on a wall at the view distance are still as dense as the planner
/// stores them, twice over each way unless they are even lines; no faster than half of what the
/// vehicle can.
double scanning_speed(const config::Mission& mission);

/// The corners of the opening in the order flown; the first is where the survey begins. Empty
/// without one. The seed says at which corner it begins.
std::vector<geometry::View> opening_views(const config::Mission& mission);

}  // namespace skycap::missions::config
