/// What the program prints about a flight.
#pragma once

#include <string>

#include "missions/file/mission.h"
#include "missions/package/flight_files.h"
#include "missions/run/survey_record.h"

namespace skycap::missions::package {

/// A line about the survey's own flight.
std::string flown_text(const file::Mission& mission, const run::SurveyRecord& record);

/// Some lines: the route, what its clearance is made of, views left out, files and notes.
std::string flight_text(const SurveyMission& flight);

}  // namespace skycap::missions::package
