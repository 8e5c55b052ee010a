/// Complete configuration of a running survey, simulated or live: planner, limits, flight and
/// start. Users derive no further values from it.
#pragma once

#include <cstdint>

#include "flight/flight_options.h"
#include "missions/session/initial_pattern_flight.h"
#include "survey/planners/planner_options.h"
#include "survey/survey_loop.h"

namespace skycap::missions::session {

struct SurveyOptions {
  survey::PlannerOptions planner;
  survey::SurveyLimits limits;
  flight::FlightOptions flight;
  StartOptions start;
};

/// Options of a single run that are not part of the mission.
struct RunOptions {
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< Number of threads (0: all processors). Does not affect results.
};

}  // namespace skycap::missions::session
