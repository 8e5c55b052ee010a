/// Printed text about a flight.
#pragma once

#include <string>

#include "flight/flight_options.h"
#include "missions/package/flight_files.h"
#include "missions/session/survey_record.h"

namespace skycap::missions::package {

/// Returns one line about the flight during the survey.
std::string survey_flight_text(const flight::FlightOptions& options,
                               const session::SurveyRecord& record);

/// Returns several lines: route, clearance budget, skipped views, files and notes. With
/// `is_verbose`, these include the gaps of tour and fleet to their lower bounds.
std::string flight_text(const SurveyMission& flight, bool is_verbose = false);

}  // namespace skycap::missions::package
