/// What the program prints about a flight.
#pragma once

#include <string>

#include "missions/package/flight_files.h"

namespace skycap::missions::package {

/// Some lines: the route, what its clearance is made of, views left out, files and notes.
std::string flight_text(const SurveyMission& flight);

}  // namespace skycap::missions::package
