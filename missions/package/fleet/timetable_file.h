/// Timetable of a fleet (timetable.csv): time, pad and route file of each sortie.
///
///     vehicle,name,sortie,file,start_s,landing_s,pad_x,pad_y,pad_z
///     1,m350_rtk,1,fleet-1.kmz,0,231.25,-38.4,124,0
///
/// Vehicles and sorties count from 1. Times are relative to the first take-off. Pads are in the
/// mission frame. Each file is in the format of the vehicle's own autopilot.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "flight/export/export.h"
#include "flight/flight_options.h"

namespace skycap::missions::package {

inline constexpr const char* timetable_name = "timetable.csv";

struct TimetableRow {
  std::size_t vehicle = 0;  ///< Index in flight.vehicles, from 0.
  std::string name;         ///< Name of the vehicle in flight.vehicles.
  std::size_t sortie = 0;   ///< Index of the vehicle's sortie, from 0.
  std::string file;         ///< File name in the folder of the timetable.
  double start = 0.0;       ///< Take-off time [s].
  double landing = 0.0;     ///< Landing time [s].
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
};

std::string timetable_csv(std::span<const TimetableRow> rows);

/// Reads a timetable. Throws Error{bad_file}, "FILE:LINE: what is wrong", for the first invalid
/// row. A row is also invalid if it is a duplicate, if its vehicle is not in the mission, or if its
/// file is missing.
std::vector<TimetableRow> read_timetable(const std::filesystem::path& path,
                                         const flight::FlightOptions& options);

/// Returns the prefix of a vehicle's route file names, such as "fleet-1" for the first vehicle.
std::string make_stem(std::size_t vehicle);

/// Returns the index of the vehicle that a route file belongs to, or an empty value for files
/// without a fleet prefix.
std::optional<std::size_t> parse_vehicle_number(std::string_view name);

/// Returns true for the timetable and for route files of a fleet.
bool is_fleet_file(std::string_view name);

/// Returns the flight options of the vehicle of a route file, with the pad from the timetable in
/// the same folder. For files without a fleet prefix, returns `options`. Throws like
/// read_timetable().
flight::FlightOptions find_file_flight(const std::filesystem::path& file,
                                       const flight::FlightOptions& options);

/// Returns the native format of a vehicle's autopilot or app.
flight::Format own_format(const flight::Vehicle& vehicle);

}  // namespace skycap::missions::package
