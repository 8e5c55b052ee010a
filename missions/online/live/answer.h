/// Answers of a live survey.
#pragma once

#include <string>

#include "flight/flight_options.h"
#include "missions/online/live/live_survey.h"

namespace skycap::missions::online {

/// Returns the next action as a one-line JSON object (docs/reference/live-protocol.md). `flight`
/// contains the survey's flight options.
std::string answer_json(const LiveSurvey& survey, const flight::FlightOptions& flight);

/// Returns the next action as one line of text for the user.
std::string answer_text(const LiveSurvey& survey);

}  // namespace skycap::missions::online
