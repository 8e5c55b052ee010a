/// Route from another program or from a flight, in the frame of a mission.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "flight/flown/flown_track.h"
#include "flight/interpreter/flight_facts.h"

namespace skycap::flight {

/// Waypoint of a route, or position of a flown track. Angles that the file does not specify are
/// `unspecified`.
struct ImportedPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< In the mission's frame [m].
  double time = 0.0;               ///< Since an arbitrary start, in ascending order [s].
  double yaw_deg = unspecified;    ///< Heading of the camera, clockwise from north.
  double pitch_deg = unspecified;  ///< Gimbal pitch, 0 at the horizon.
  double hold = 0.0;               ///< Rest time [s].
  int captures = 0;                ///< Number of photos or scans.
  std::string item;                ///< Name in the file, such as "line 12".
  std::size_t vehicle = 0;         ///< Number of the vehicle of a fleet, from 1. 0: unspecified.
};

struct ImportedRoute {
  std::string kind{};     ///< Kind of file, such as "waypoint table".
  std::string heights{};  ///< Height reference that was used.
  /// Densely sampled track of a flight. False: list of waypoints.
  bool is_track = false;
  /// Heights refer to the take-off point.
  bool is_above_takeoff = false;
  std::vector<ImportedPoint> points{};  ///< In flight order.
  std::vector<std::string> warnings{};
};

/// Reads a route or a track. These kinds are supported:
///
/// - .csv: waypoint table with the columns latitude, longitude and a height; with a column of times
///   it is a track, see read_flown_log(). Or one with the columns x, y, z [m, mission frame],
///   heading_deg, gimbal_pitch_deg and photos; for fleets, with a column vehicle
/// - .kml: LineString or gx:Track
/// - .plan, .waypoints, .kmz, .litchi.csv, .geojson: route files, see interpret_file()
/// - logs and tracks of read_flown_log()
///
/// `facts` contain the georeference and the take-off point, to which heights above take-off refer.
/// Every row of a waypoint table must be valid. Throws Error{bad_file} with the file name and the
/// line, and the errors of place_track().
ImportedRoute read_imported_route(const std::filesystem::path& file, const FlightFacts& facts,
                                  bool is_georeferenced, TrackHeights heights);

/// Removes the climb from the pad and the landing on it at both ends of a route: the positions
/// within `radius` [m] of the pad horizontally and less than `height` [m] above it. Returns the
/// number of removed positions.
std::size_t remove_pad_column(ImportedRoute& route, const Eigen::Vector3d& pad, double radius,
                              double height);

/// Content of a KML file or of a waypoint table, before it is placed in a frame.
struct GeodeticRoute {
  std::string kind{};
  bool is_track = false;
  std::vector<FilePoint> points{};
  std::vector<std::string> items{};  ///< One per point.
};

/// Reads a waypoint table. `heights` selects the column of heights, or declares the reference of
/// the only one. Throws Error{bad_file} with the line of the first invalid row.
GeodeticRoute read_waypoint_table(std::string_view text, TrackHeights heights);

/// Reads the gx:Track or the LineString of a KML file. A LineString named "path" is preferred;
/// otherwise the file must contain a single one. Heights with the altitude mode "absolute" are
/// above mean sea level. Other modes are accepted only if `heights` states the reference.
GeodeticRoute read_kml_route(const std::string& text, TrackHeights heights);

}  // namespace skycap::flight
