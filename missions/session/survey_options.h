/// What a survey in progress works with, simulated or real: its planner, its limits, how the
/// vehicle flies, and where it begins. Complete; nothing in it is derived by those who use it.
#pragma once

#include <cstdint>

#include "flight/flight_options.h"
#include "missions/session/opening_flight.h"
#include "survey/planners/planner_options.h"
#include "survey/survey_loop.h"

namespace skycap::missions::session {

struct SurveyOptions {
  survey::PlannerOptions planner;
  survey::SurveyLimits limits;
  flight::FlightOptions flight;
  StartOptions start;
};

/// What belongs to one run of a mission, and to no mission.
struct RunOptions {
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< zero: all processors; does not change a result
};

}  // namespace skycap::missions::session
