/// Instructions for the pilot of a planned flight, printed after the summary.
#pragma once

#include <string>

#include "flight/flight_options.h"
#include "missions/package/flight_files.h"

namespace skycap::missions::package {

/// Returns numbered steps for the autopilot of the vehicle, or of each vehicle of a fleet. These
/// are followed by a list of unverified conditions and by warnings, one line "Warning: ..." each.
/// Returns an empty string without a route.
std::string pilot_text(const flight::FlightOptions& options, const SurveyMission& flight);

}  // namespace skycap::missions::package
