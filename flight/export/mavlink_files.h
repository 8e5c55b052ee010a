/// MAVLink mission files: QGroundControl's .plan and the "QGC WPL 110" text format.
///
/// Neither format has an official schema. The references are the loaders of QGroundControl, MAVSDK
/// and Mission Planner. The validators apply the strictest of their rules. The readers accept what
/// each program reads from its own files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flight/export/flight_plan.h"
#include "flight/export/mission_items.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// Area of a geofence. Circles are approximated by polygons: slightly smaller for inclusion areas,
/// slightly larger for no-fly areas.
struct FenceArea {
  std::string name;  ///< Location within the file.
  bool is_inclusion = false;
  std::vector<GeodeticPoint> corners;  ///< Heights are unused.
};

/// Format-independent content of a mission file.
struct MavlinkMission {
  std::vector<MissionItem> items;  ///< Items without home.
  std::optional<AutopilotType>
      autopilot;  ///< Dialect of the target autopilot, if the file specifies it.
  std::optional<GeodeticPoint> home;  ///< Planned home position with height AMSL.
  std::string home_name;              ///< Location within the file.
  bool supports_fence = false;        ///< True if the format supports a geofence.
  std::vector<FenceArea> fence;
  std::vector<GeodeticPoint> rally;  ///< Rally points with heights above home.
};

/// Returns a .plan file. Home is stored AMSL, which requires the geoid undulation. No-fly volumes
/// are flattened, see flat_no_fly(). Throws the same errors as mission_items().
std::string write_plan(const FlightPlan& plan);

/// Returns the problems of a .plan file, empty if it is valid.
Problems validate_plan(const std::string& text);

/// Reads a .plan file. Throws Error{bad_file} with the first problem.
MavlinkMission read_plan(const std::string& text);

/// Returns a .waypoints file. In the ArduPilot dialect, line 0 is home and requires the geoid
/// undulation.
std::string write_waypoints(const FlightPlan& plan);

/// Returns the problems of a .waypoints file for that autopilot, empty if it is valid.
Problems validate_waypoints(const std::string& text, std::optional<AutopilotType> autopilot = {});

/// Reads a .waypoints file. A file that starts with a home item counts as ArduPilot's. Throws
/// Error{bad_file} with the first problem.
MavlinkMission read_waypoints(const std::string& text);

}  // namespace skycap::flight
