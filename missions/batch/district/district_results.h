/// The figures of a district: district.json and targets.csv.
#pragma once

#include <span>
#include <string>

#include "missions/batch/district/district_flight.h"

namespace skycap::missions::batch {

/// What the page that shows it (missions/report/district_page.h) is made from.
inline constexpr const char* results_name = "district.json";
inline constexpr const char* table_name = "targets.csv";

/// Everything that was surveyed, and how it is flown. Paths of packages count from `out`.
std::string results_json(const DistrictFile& district, const Prepared& prepared,
                         std::span<const SurveyedTarget> targets, const DistrictFlight& flight,
                         const std::filesystem::path& out);

/// A line for each target: the same bytes wherever items ran.
std::string targets_csv(std::span<const SurveyedTarget> targets, const DistrictFlight& flight);

/// The summary for the terminal.
std::string results_text(std::span<const SurveyedTarget> targets, const DistrictFlight& flight);

}  // namespace skycap::missions::batch
