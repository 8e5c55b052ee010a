/// A mission's live survey, and what it answers.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "missions/config/mission.h"
#include "missions/online/live/live_survey.h"

namespace skycap::missions::online {

/// Opens the live survey of a mission in a folder. Its first view is the mission's, if it says one;
/// a mission that has a scene, too, begins where `plan` does, which is for rehearsals: the scene is
/// then loaded, relative paths from `mission_folder` on. Throws what SurveyScene and LiveSurvey
/// throw.
std::unique_ptr<LiveSurvey> open_survey(const config::Mission& mission,
                                        const std::filesystem::path& mission_folder,
                                        const std::filesystem::path& survey_folder);

/// What to do next as a JSON object in one line: docs/live.md describes it.
std::string answer_json(const LiveSurvey& survey, const config::Mission& mission);

/// The same in one line for people.
std::string answer_text(const LiveSurvey& survey);

}  // namespace skycap::missions::online
