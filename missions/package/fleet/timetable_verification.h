/// Verification of the separation between vehicles, based only on a timetable and its route files.
#pragma once

#include <filesystem>
#include <string>

#include "flight/fleet/fleet_flights.h"
#include "flight/flight_options.h"
#include "flight/interpreter/interpreted_route.h"
#include "flight/monte_carlo/flight_script.h"
#include "missions/package/fleet/timetable_file.h"

namespace skycap::missions::package {

/// Flight of a vehicle through a route file: path segments and timing.
struct InterpretedFile {
  flight::InterpretedRoute route;
  flight::FlightScript script;  ///< One leg for each segment of the route.
};

/// Simulates the flight of a file with this content. `own` contains the flight options of its
/// vehicle, which takes off from its pad. Throws Error{bad_file} with the first problem of the
/// file.
InterpretedFile interpret_flight_file(const flight::FlightOptions& own, const std::string& content,
                                      flight::Format format);

/// Simulates the flight of a row's file in the folder of the timetable `path`. Error messages
/// contain the file name.
InterpretedFile interpret_flight_file(const std::filesystem::path& path, const TimetableRow& row,
                                      const flight::FlightOptions& options);

struct TimetableVerification {
  flight::Problems problems;  ///< Rows and pairs that could not be verified.
  std::size_t sorties = 0;
  double makespan = 0.0;  ///< Time of the last landing [s].
  /// Verified lower bound on the distance between airborne vehicles, limited to `up_to` [m].
  double distance = 0.0;
};

/// Simulates all route files and verifies four conditions. Vehicles keep flight.separation at all
/// times, for all timing errors within flight.timing_tolerance. They keep flight.clearance to
/// vehicles on the ground. Landings match the timetable. The sorties of a vehicle do not overlap.
/// Throws Error{bad_file} if the timetable or a file cannot be read.
TimetableVerification verify_timetable(const std::filesystem::path& path,
                                       const flight::FlightOptions& options, double up_to);

/// Returns all sorties of a timetable for the simulator. Throws like verify_timetable().
std::vector<flight::FleetFlight> fleet_flights(const std::filesystem::path& path,
                                               const flight::FlightOptions& options);

/// Returns the camera positions in a vehicle's files whose photos may be missing at the time
/// `after` [s] because of delays up to flight.timing_tolerance. Throws like verify_timetable().
std::vector<Eigen::Vector3d> left_by(const std::filesystem::path& path,
                                     const flight::FlightOptions& options, std::size_t vehicle,
                                     double after);

}  // namespace skycap::missions::package
