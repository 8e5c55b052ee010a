/// Mission files of the MAVLink world: QGroundControl's .plan and the "QGC WPL 110" text format.
///
/// There is no official schema of either: the loaders of QGroundControl, MAVSDK and Mission Planner
/// are. The validators ask for what the strictest of them asks for; the readers read what each
/// program reads of its own files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flight/export/flight_plan.h"
#include "flight/export/mission_items.h"
#include "flight/export/text.h"

namespace skycap::flight {

/// An area of a geofence. Circles are polygons round them: fences a little smaller than the circle,
/// no-fly areas a little larger.
struct FenceArea {
  std::string name;  ///< its place in the file
  bool is_inclusion = false;
  std::vector<GeodeticPoint> corners;  ///< heights mean nothing
};

/// What a mission file holds beside its format's own matters.
struct MissionFile {
  std::vector<MissionItem> items;     ///< without home
  std::optional<Dialect> dialect;     ///< of the autopilot it is written for, if it says
  std::optional<GeodeticPoint> home;  ///< as planned; height above mean sea level
  std::string home_name;              ///< its place in the file
  bool holds_fence = false;           ///< whether the format has a geofence
  std::vector<FenceArea> fence;
  std::vector<GeodeticPoint> rally;  ///< heights above home
};

/// A .plan file. Needs the geoid undulation (home is stored above mean sea level). No-fly volumes
/// are flattened as flat_no_fly() says. Throws what mission_items() throws.
std::string write_plan(const FlightPlan& plan);

/// What is wrong with a .plan file; empty when it is good.
Problems validate_plan(const std::string& text);

/// What it holds. Throws Error{bad_file} with the first problem.
MissionFile read_plan(const std::string& text);

/// A .waypoints file; in the ArduPilot dialect line 0 is home and needs the geoid undulation.
std::string write_waypoints(const FlightPlan& plan);

/// What is wrong with a .waypoints file for that autopilot; empty when it is good.
Problems validate_waypoints(const std::string& text, std::optional<Dialect> dialect = {});

/// What it holds; a file that begins with a home is ArduPilot's. Throws Error{bad_file} with the
/// first problem.
MissionFile read_waypoints(const std::string& text);

}  // namespace skycap::flight
