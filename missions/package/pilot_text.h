/// Instructions for the pilot of a planned flight, printed after the summary.
#pragma once

#include <string>
#include <vector>

#include "flight/flight_options.h"
#include "missions/package/flight_files.h"

namespace skycap::missions::package {

/// Ordered steps before the flight of one vehicle.
struct PilotSteps {
  std::string whom;  ///< Name of the vehicle.
  std::vector<std::string> steps;
};

/// Returns the steps for the vehicle's autopilot, per vehicle of a fleet. Empty without a route.
std::vector<PilotSteps> pilot_steps(const flight::FlightOptions& options,
                                    const SurveyMission& flight);

/// Returns the list of items that were not verified and that the pilot must check.
std::string unverified_text(const flight::FlightOptions& options, const SurveyMission& flight);

/// Returns the warnings, without the prefix "Warning" and the full stop.
std::vector<std::string> pilot_warnings(const SurveyMission& flight);

/// Returns numbered steps for the autopilot of the vehicle, or of each vehicle of a fleet. These
/// are followed by a list of unverified conditions. Then follow the warnings, one line
/// "Warning: ..." each: first `more`, without prefix and full stop, then pilot_warnings(). Without
/// a route, returns `more` only.
std::string pilot_text(const flight::FlightOptions& options, const SurveyMission& flight,
                       const std::vector<std::string>& more = {});

}  // namespace skycap::missions::package
