/// The mission that was chosen anew (missions/package/replan), beside the survey's: in
/// summary.json, and as the program prints it.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "flight/route/route.h"
#include "missions/package/package.h"
#include "missions/package/replan/mission_choice.h"
#include "missions/session/survey_options.h"
#include "missions/session/survey_record.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::package {

/// What the choice depends on where that sensor is flown.
ChoiceOptions choice_options(const sim::SurveySensorOptions& sensor,
                             const session::RunOptions& run);

/// The choice between `present`, the route through the survey's views, and views chosen anew. The
/// record is of a flown survey that knows its surface. Coverage when it is flown again is measured
/// where `coverage` says how.
AnewMission anew_mission(const session::SurveyOptions& options, const ChoiceOptions& choice,
                         const session::SurveyRecord& record, const CoverageFigures& coverage,
                         flight::Route present, const std::stop_token& stop);

/// What these views cover, or scans of a scanner, where `coverage` says how that is measured.
FlownAgain flown_again(const CoverageFigures& coverage,
                       const std::vector<session::ViewInFlight>& views);

/// For the summary, and what the program prints.
nlohmann::ordered_json again_json(const FlownAgain& again);
std::string again_text(const FlownAgain& again);

/// `flight.replanned` of the summary.
nlohmann::ordered_json anew_json(const AnewMission& mission);

/// The stations that it has; nothing if the mission takes the survey's views. Throws what
/// nlohmann::json throws, and Error{bad_file} on values that no station has; `name` stands for the
/// file.
std::optional<package::StationPlan> anew_stations(const nlohmann::ordered_json& json,
                                                  const std::string& name);

/// What the program prints.
std::string anew_text(const AnewMission& mission);

}  // namespace skycap::missions::package
