/// Entry point for flying a mission's live survey.
#pragma once

#include <stop_token>

#include "flight/flight_options.h"
#include "flight/mavlink/port.h"
#include "missions/online/guided/live_flight.h"
#include "missions/online/live/live_survey.h"

namespace skycap::missions::online {

/// Throws Error{bad_config} naming the key if the mission has no ArduPilot vehicle, no
/// georeference, or en-route scans.
void require_flyable(const flight::FlightOptions& flight);

/// Flies the survey with the autopilot behind `port`. The flight starts and ends at the pad unless
/// a problem occurs. Returns after all background work has finished. `flight` contains the survey's
/// flight options and must satisfy require_flyable(); dependent entries of `options` are filled in
/// here.
FlightEnd fly_survey(const flight::FlightOptions& flight, LiveSurvey& survey,
                     flight::mavlink::Port& port, Sensor sensor, FlightOptions options,
                     const std::stop_token& stop);

}  // namespace skycap::missions::online
