/// One simulated survey of a mission, judged while it runs.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "missions/evaluation/simulation_options.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/session/survey_record.h"
#include "missions/simulation/survey_journal.h"

namespace skycap::missions::simulation {

/// Surveys the mission's scene with that seed and so many threads (zero: all processors). The
/// record does not depend on the threads but for its times. A mission with a vehicle goes only to
/// views that it can safely reach; without one, whatever the planner, only to places that
/// scene.is_reachable() knows a way to. `report` is told of each view; it may be empty. Throws what
/// planner, sensor and session::SurveyFlight throw. With a journal the survey is written down, and
/// goes on where the journal's ended: the record is the same but for its times.
session::SurveyRecord run_survey(const evaluation::SimulationOptions& options,
                                 const evaluation::SurveyScene& scene, std::uint64_t seed,
                                 unsigned threads, std::stop_token stop = {},
                                 const std::function<void(const session::JudgedView&)>& report = {},
                                 SurveyJournal* journal = nullptr);

}  // namespace skycap::missions::simulation
