/// Opens live surveys. With a scene, a live survey is a rehearsal: it starts from the same view as
/// `plan`, and its sensor may be simulated.
#pragma once

#include <filesystem>
#include <memory>

#include "missions/config/mission_setup.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/online/guided/live_flight.h"
#include "missions/online/live/live_survey.h"
#include "missions/session/survey_options.h"

namespace skycap::missions::cli {

/// Opens the live survey of a mission in `survey_folder`. The first view is taken from the mission,
/// if set. For missions with a scene, the scene is loaded and the start is that of `plan`.
/// `mission_folder` is the base of relative paths in the scene. Throws the errors of SurveyScene
/// and LiveSurvey.
std::unique_ptr<online::LiveSurvey> open_survey(const config::MissionSetup& setup,
                                                const std::filesystem::path& mission_folder,
                                                const std::filesystem::path& survey_folder);

/// Returns the mission's simulated sensor for hardware-in-the-loop tests. It measures the mission's
/// scene from the vehicle's estimated pose. Throws Error{bad_config} if the mission has no scene,
/// and the errors of SurveyScene.
online::Sensor simulated_sensor(const evaluation::SimulationOptions& options,
                                const std::filesystem::path& mission_folder,
                                const session::RunOptions& run);

}  // namespace skycap::missions::cli
