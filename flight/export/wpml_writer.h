/// Text of the two files of a DJI mission, see wpml_file.h.
#pragma once

#include <string>

#include "flight/export/flight_plan.h"

namespace skycap::flight {

namespace wpml {
/// Namespace without its version suffix.
inline constexpr const char* wpml_namespace = "http://www.dji.com/wpmz/";
/// Turn mode with straight legs and a stop at each end.
inline constexpr const char* stop_turn = "toPointAndStopWithDiscontinuityCurvature";
/// The aircraft turns within the damping distance and does not pass the waypoint itself.
inline constexpr const char* passing_turn = "coordinateTurn";
}  // namespace wpml

std::string template_kml(const FlightPlan& plan);
std::string waylines_wpml(const FlightPlan& plan);

}  // namespace skycap::flight
