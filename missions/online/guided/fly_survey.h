/// A mission's live survey, flown.
#pragma once

#include <stop_token>

#include "flight/flight_options.h"
#include "flight/link/port.h"
#include "missions/online/guided/live_flight.h"
#include "missions/online/live/live_survey.h"

namespace skycap::missions::online {

/// Throws Error{bad_config} naming the key if the mission cannot be flown from here: without an
/// ArduPilot's vehicle, or without a place on the Earth.
void require_flyable(const flight::FlightOptions& flight);

/// Flies the survey on the autopilot behind `port`, from the pad and back to it or until there is
/// trouble; returns when nothing is left that goes on beside the flight. `flight`, that
/// of the survey's options, must be flyable; options that follow from it are filled in.
FlightEnd fly_survey(const flight::FlightOptions& flight, LiveSurvey& survey,
                     flight::mavlink::Port& port, Sensor sensor, FlightOptions options,
                     const std::stop_token& stop);

}  // namespace skycap::missions::online
