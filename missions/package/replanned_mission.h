/// Output of the replanned mission (missions/package/replan): planning, summary.json and printed
/// text.
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

/// Returns the replanning options for a mission with the sensor `sensor`.
ChoiceOptions choice_options(const sim::SurveySensorOptions& sensor,
                             const session::RunOptions& run);

/// Compares `present`, the route through the survey's views, with replanned views and returns the
/// better mission. `record` must contain a flown survey with a known surface. The coverage of the
/// simulated re-flight is computed if `coverage` provides a function for it.
ReplannedMission replan_mission(const session::SurveyOptions& options, const ChoiceOptions& choice,
                                const session::SurveyRecord& record,
                                const CoverageFigures& coverage, flight::Route present,
                                const std::stop_token& stop);

/// Returns the coverage of a simulated re-flight with these views or, for scanners, scans.
/// `coverage.fly_again` must be set.
ReflightCoverage simulate_reflight(const CoverageFigures& coverage,
                                   const std::vector<session::ViewInFlight>& views);
/// The same where it is known which samples are covered.
ReflightCoverage simulate_reflight(const CoverageFigures& coverage,
                                   const simulation::CoveredAgain& covered);

/// Returns the coverage of a simulated re-flight for the summary (JSON) and for printing (text).
nlohmann::ordered_json again_json(const ReflightCoverage& again);
std::string again_text(const ReflightCoverage& again);

/// Returns `flight.replanned` of the summary.
nlohmann::ordered_json replanned_json(const ReplannedMission& mission);

/// Returns the stations of `flight.replanned`, or an empty value if the mission uses the survey's
/// views. Throws exceptions of nlohmann::json, and Error{bad_file} for invalid values. `name` is
/// the file name in messages.
std::optional<package::CapturePlan> replanned_capture_points(const nlohmann::ordered_json& json,
                                                             const std::string& name);

/// Returns the printed text about a replanned mission.
std::string replanned_text(const ReplannedMission& mission);

}  // namespace skycap::missions::package
