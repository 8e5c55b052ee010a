/// Simulation of one survey of a mission with evaluation of each view.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_record.h"
#include "missions/simulation/survey_journal.h"

namespace skycap::missions::simulation {

/// Surveys the mission's scene with `seed` and `threads` threads (0: all processors). The record
/// does not depend on the number of threads except for its times.
///
/// Missions with a vehicle use only views that the vehicle can reach safely. Other missions use
/// only positions for which scene.is_reachable() is true. `report` (optional) is called after each
/// view. With a journal, the survey is recorded and resumes where the journal ends; the record is
/// the same except for its times. Throws all errors of planner, sensor and session::SurveyFlight.
session::SurveyRecord run_survey(
    const evaluation::SimulationOptions& options, const evaluation::SurveyScene& scene,
    std::uint64_t seed, unsigned threads, std::stop_token stop = {},
    const std::function<void(const session::EvaluatedView&)>& report = {},
    SurveyJournal* journal = nullptr);

}  // namespace skycap::missions::simulation
