/// Instructions for the pilot of a planned flight, printed after the summary.
#pragma once

#include <string>
#include <vector>

#include "flight/flight_options.h"
#include "missions/package/flight_files.h"

namespace skycap::missions::package {

/// What is to be done before the flight of one vehicle, in this order.
struct PilotSteps {
  std::string whom;  ///< the vehicle
  std::vector<std::string> steps;
};

/// For the vehicle's own autopilot and for no other, by vehicle of a fleet. Empty if there is no
/// route.
std::vector<PilotSteps> pilot_steps(const flight::FlightOptions& options,
                                    const SurveyMission& flight);

/// What was not verified, and the pilot must check.
std::string unverified_text(const flight::FlightOptions& options, const SurveyMission& flight);

/// Warnings, without the word and the full stop.
std::vector<std::string> pilot_warnings(const SurveyMission& flight);

/// Returns numbered steps for the autopilot of the vehicle, or of each vehicle of a fleet. These
/// are followed by a list of unverified conditions and by warnings, one line "Warning: ..." each.
/// Returns an empty string without a route.
std::string pilot_text(const flight::FlightOptions& options, const SurveyMission& flight);

}  // namespace skycap::missions::package
