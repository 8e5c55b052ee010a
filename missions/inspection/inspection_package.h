/// Inspection read from its results: the flight that was planned, for export in other formats and
/// for other vehicles, and for test flights.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/export.h"
#include "geometry/io/output_folder.h"
#include "missions/config/key_override.h"
#include "missions/config/mission_setup.h"
#include "missions/inspection/inspection_flight.h"
#include "missions/inspection/inspection_site.h"
#include "survey/inspection/smooth_route.h"

namespace skycap::missions::inspection {

struct InspectionPackage {
  config::MissionSetup setup;
  std::shared_ptr<const InspectionSpace> space;          ///< Read again from the structure's files.
  std::vector<survey::inspection::FlightSample> flight;  ///< Planned flight of the camera.
  std::optional<Eigen::Vector3d> pad;  ///< Take-off point of the route files, if there are any.
  std::size_t attainable = 0;          ///< Points of the structure that some position sees.
};

/// Reads the inspection in `folder`. Returns nullopt for results of other missions. `overrides`
/// replace keys of the mission, such as flight.vehicle. Throws Error{bad_file} naming the file that
/// is missing or invalid.
std::optional<InspectionPackage> read_inspection(const std::filesystem::path& folder,
                                                 const std::vector<config::KeyOverride>& overrides);

struct InspectionExport {
  /// Flight with waypoints; empty if only setpoints are exported.
  std::optional<InspectionFlight> flight;
  std::size_t points = 0;              ///< Number of points of the structure.
  std::vector<std::string> setpoints;  ///< Names of the files with setpoints.
  std::vector<std::string> warnings;   ///< Warnings for the user, displayed last.
};

/// Stages the planned flight in each format; the caller commits. Mission files are planned for the
/// vehicle of the package, read back and verified.
///
/// Throws Error{bad_usage} for a format that cannot command the flight, or that the vehicle's
/// autopilot does not read. Throws Error{bad_geometry} if the autopilot's curve could deviate from
/// the planned one by more than flown_deviation. Also throws the errors of plan_inspection_flight()
/// and package::stage_flight().
InspectionExport export_inspection(const InspectionPackage& package,
                                   std::span<const flight::Format> formats,
                                   const std::stop_token& stop, geometry::OutputFolder& folder);

/// Returns the printed lines of an export, with the steps for the pilot and the warnings.
std::string export_text(const InspectionPackage& package, const InspectionExport& exported);

}  // namespace skycap::missions::inspection
