/// Printable page for the crew on site: map, pad, return altitude, steps, sorties, batteries,
/// checks, and the surface that will remain uncovered.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/obstacles.h"
#include "flight/flight_options.h"
#include "missions/package/flight_files.h"

namespace skycap::missions::package {

/// Name of the file in a mission package.
inline constexpr const char* field_sheet_name = "field_sheet.html";

/// Titled list on the sheet.
struct SheetList {
  std::string title;
  std::vector<std::string> items;
};

/// Content of the sheet that does not depend on the flight.
struct FieldSheetSite {
  std::string mission;  ///< Name of the mission.
  std::string sensor;   ///< Sensor name for display.
  double survey_coverage = 0.0;
  std::string coverage_of =
      "of the surface covered by the survey";  ///< Meaning of `survey_coverage`.
  /// Sample positions on the surface to be surveyed, for the map. May be empty.
  std::span<const Eigen::Vector3f> surface{};
  /// For each sample position, 1 if the survey covers it. The coverage of the written files is used
  /// instead if it is known. May be empty.
  std::span<const std::uint8_t> is_covered{};
  std::vector<SheetList> lists{};       ///< Further lists, after the checks.
  std::vector<std::string> warnings{};  ///< Warnings before those of the flight.
};

/// Returns an HTML page for A4 without scripts or external files. The mission must have a route.
std::string field_sheet(const FieldSheetSite& site, const flight::FlightOptions& options,
                        const SurveyMission& mission);

}  // namespace skycap::missions::package
