/// Result files and printed summary of an inspection mission.
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "flight/export/export.h"
#include "geometry/io/output_folder.h"
#include "missions/config/mission_setup.h"
#include "missions/inspection/inspection_mission.h"

namespace skycap::missions::inspection {

inline constexpr const char* flight_name = "inspection.csv";
inline constexpr const char* corners_name = "corners.csv";
inline constexpr const char* structure_name = "structure.ply";

/// Returns the lines of an evaluation: surface seen, views, distances and limits of motion.
std::string evaluation_text(const survey::inspection::FlightEvaluation& evaluation);
nlohmann::ordered_json evaluation_json(const survey::inspection::FlightEvaluation& evaluation);

/// Returns one line: waypoints of the route files, the deviation of the flown curve, and the
/// fraction of the `points` of the structure that it sees.
std::string deviation_text(const InspectionFlight& flight, std::size_t points);

/// Stages a flight as setpoints (CSV) or camera poses (TUM), and returns the name of the file.
/// `format` is csv, ned_csv or tum.
std::string stage_setpoints(std::span<const survey::inspection::FlightSample> flight,
                            flight::Format format, geometry::OutputFolder& folder);

/// Returns the printed summary of a plan, without the folder and the warnings.
std::string plan_text(const config::MissionSetup& setup, const InspectionMission& mission);

/// Returns the route with its files, the steps for the pilot, and a line "Warning: ..." for each
/// warning. Without route files, returns only the warnings.
std::string warnings_text(const config::MissionSetup& setup, const InspectionMission& mission);

/// Stages summary.json, the flight, and structure.ply: the points of the structure with the rules
/// by which they are seen. The files of the flight are inspection.csv, corners.csv,
/// setpoints.enu.csv, setpoints.ned.csv and camera.tum. Also stages the route files for the
/// vehicle's autopilot, each read back and verified, and sets them in `mission`. The commit removes
/// files of earlier runs of another kind.
void stage_inspection_mission(const config::MissionSetup& setup, const InspectionSpace& space,
                              InspectionMission& mission, geometry::OutputFolder& folder);

}  // namespace skycap::missions::inspection
