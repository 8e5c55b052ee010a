/// What the program prints about a flight.
#pragma once

#include <string>

#include "flight/flight_options.h"
#include "missions/package/flight_files.h"
#include "missions/session/survey_record.h"

namespace skycap::missions::package {

/// A line about the survey's own flight.
std::string flown_text(const flight::FlightOptions& options, const session::SurveyRecord& record);

/// Some lines: the route, its clearance budget, skipped views, files and notes; with `is_verbose`
/// also how far the tour and the fleet are from their lower bounds.
std::string flight_text(const SurveyMission& flight, bool is_verbose = false);

}  // namespace skycap::missions::package
