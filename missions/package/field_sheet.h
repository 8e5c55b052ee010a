/// One printable page for the crew on site: map, pad, return altitude, steps, sorties and
/// batteries, what to check, and what will be missing.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/obstacles.h"
#include "flight/flight_options.h"
#include "missions/package/flight_files.h"

namespace skycap::missions::package {

/// The file of a package that holds it.
inline constexpr const char* field_sheet_name = "field_sheet.html";

/// What the sheet says of a mission besides its flight.
struct FieldSheetSite {
  std::string mission;  ///< its name
  std::string sensor;   ///< for people
  double survey_coverage = 0.0;
  /// Places of the surface to be surveyed; from all of them the map is drawn. May be empty.
  std::span<const Eigen::Vector3f> surface{};
  /// For each of them, 1 if the survey covers it; what the files cover is taken instead where that
  /// is known. May be empty.
  std::span<const std::uint8_t> is_covered{};
};

/// A page of HTML without scripts or other files, for A4. The mission must have a route.
std::string field_sheet(const FieldSheetSite& site, const flight::FlightOptions& options,
                        const SurveyMission& mission);

}  // namespace skycap::missions::package
