/// Results of a district: district.json and targets.csv.
#pragma once

#include <span>
#include <string>

#include "missions/batch/district/district_flight.h"

namespace skycap::missions::batch {

/// Input files of the HTML report (missions/report/district_page.h).
inline constexpr const char* results_name = "district.json";
inline constexpr const char* table_name = "targets.csv";

/// Returns all survey results and the joint flight as JSON. Package paths are relative to `out`.
std::string results_json(const DistrictFile& district, const DistrictPlan& district_plan,
                         std::span<const SurveyedTarget> targets, const DistrictFlight& flight,
                         const std::filesystem::path& out);

/// Returns one CSV line per target. The output does not depend on the machines that ran the items.
std::string targets_csv(std::span<const SurveyedTarget> targets, const DistrictFlight& flight);

/// Returns the summary for the terminal.
std::string results_text(std::span<const SurveyedTarget> targets, const DistrictFlight& flight);

}  // namespace skycap::missions::batch
