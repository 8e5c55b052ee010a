/// Opens live surveys. Those of missions with a scene are rehearsals: they begin where `plan` does,
/// and their sensor may be simulated.
#pragma once

#include <filesystem>
#include <memory>

#include "missions/config/mission_setup.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/online/guided/live_flight.h"
#include "missions/online/live/live_survey.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::cli {

/// Opens the live survey of a mission in a folder. Its first view is the mission's, if it says one;
/// a mission that has a scene, too, begins where `plan` does: the scene is then loaded, relative
/// paths from `mission_folder` on. Throws what SurveyScene and LiveSurvey throw.
std::unique_ptr<online::LiveSurvey> open_survey(const config::MissionSetup& setup,
                                                const std::filesystem::path& mission_folder,
                                                const std::filesystem::path& survey_folder);

/// The mission's simulated sensor in the mission's scene, at the place where the vehicle takes
/// itself to be: hardware in the loop. Throws Error{bad_config} if the mission has no scene, and
/// what SurveyScene throws.
online::Sensor simulated_sensor(const evaluation::SimulationOptions& options,
                                const std::filesystem::path& mission_folder,
                                const session::RunOptions& run);

}  // namespace skycap::missions::cli
