/// Proves from a timetable and its route files alone that vehicles keep apart.
#pragma once

#include <filesystem>
#include <string>

#include "flight/fleet/fleet_flights.h"
#include "flight/flight_options.h"
#include "flight/fly_test/flight_script.h"
#include "flight/interpreter/flown_route.h"
#include "missions/package/fleet/timetable_file.h"

namespace skycap::missions::package {

/// What a vehicle does with a route file: stretch by stretch, and in time.
struct FlownFile {
  flight::FlownRoute route;
  flight::FlightScript script;  ///< a leg for each of its pieces
};

/// The flight of a file with that content; `own` is that of its vehicle, with the pad as its
/// take-off. Throws Error{bad_file} with the file's first problem.
FlownFile flown_file(const flight::FlightOptions& own, const std::string& content,
                     flight::Format format);

/// Of the file of a row of the timetable at `path`. Errors name it.
FlownFile flown_file(const std::filesystem::path& path, const TimetableRow& row,
                     const flight::FlightOptions& options);

struct TimetableProof {
  flight::Problems problems;  ///< rows and pairs that are not proven
  std::size_t sorties = 0;
  double makespan = 0.0;  ///< until the last landing [s]
  double distance = 0.0;  ///< proven lower bound between any two in the air, at most `up_to` [m]
};

/// Flies every file as its vehicle would and holds the flights to flight.separation at all times,
/// each as early or late as flight.timing_tolerance allows; to flight.clearance from where others
/// stand on the ground; to the landings that the timetable states; and to one sortie after another
/// of each vehicle. Throws Error{bad_file} if the timetable or a file cannot be read.
TimetableProof prove_timetable(const std::filesystem::path& path,
                               const flight::FlightOptions& options, double up_to);

/// All sorties of a timetable, ready for the simulator. Throws as prove_timetable().
std::vector<flight::FleetFlight> fleet_flights(const std::filesystem::path& path,
                                               const flight::FlightOptions& options);

/// The views that a vehicle has not certainly photographed by the time `after` its timetable began,
/// being late by as much as flight.timing_tolerance allows: places that its files photograph from.
/// Throws as prove_timetable().
std::vector<Eigen::Vector3d> left_by(const std::filesystem::path& path,
                                     const flight::FlightOptions& options, std::size_t vehicle,
                                     double after);

}  // namespace skycap::missions::package
