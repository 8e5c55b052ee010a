/// Printed text about a flight.
#pragma once

#include <string>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

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

/// `flight` of the summary for a route and its files from a pad, in metres, seconds and watt hours.
nlohmann::ordered_json route_json(const SurveyMission& flight, const Eigen::Vector3d& pad);

}  // namespace skycap::missions::package
