/// The two files of a DJI mission as texts; wpml_file.h says what they are for.
#pragma once

#include <string>

#include "flight/export/flight_plan.h"

namespace skycap::flight {

namespace wpml {
inline constexpr const char* wpml_namespace = "http://www.dji.com/wpmz/";  ///< a version follows
/// The turn that keeps to straight legs and stops at their ends.
inline constexpr const char* stop_turn = "toPointAndStopWithDiscontinuityCurvature";
}  // namespace wpml

std::string template_kml(const FlightPlan& plan);
std::string waylines_wpml(const FlightPlan& plan);

}  // namespace skycap::flight
