/// What the pilot must do with a planned flight: printed after its summary.
#pragma once

#include <string>

#include "flight/flight_options.h"
#include "missions/package/flight_files.h"

namespace skycap::missions::package {

/// Numbered steps for the vehicle's own autopilot and for no other, by vehicle of a fleet; then
/// what was not verified; then warnings, a line "Warning: ..." each. Empty if there is no route.
std::string pilot_text(const flight::FlightOptions& options, const SurveyMission& flight);

}  // namespace skycap::missions::package
