/// What a live survey answers.
#pragma once

#include <string>

#include "flight/flight_options.h"
#include "missions/online/live/live_survey.h"

namespace skycap::missions::online {

/// What to do next as a JSON object in one line: docs/reference/live-protocol.md describes it.
/// `flight` is that of the survey's options.
std::string answer_json(const LiveSurvey& survey, const flight::FlightOptions& flight);

/// The same in one line for people.
std::string answer_text(const LiveSurvey& survey);

}  // namespace skycap::missions::online
