/// timetable.csv: when each sortie of a fleet takes off, from where, and by which file.
///
///     vehicle,name,sortie,file,start_s,landing_s,pad_x,pad_y,pad_z
///     1,m350_rtk,1,fleet-1.kmz,0,231.25,-38.4,124,0
///
/// Vehicles and sorties count from 1, times from the first take-off; pads are in the mission's
/// frame. The file is the one that the vehicle's own autopilot flies.
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
  std::size_t vehicle = 0;  ///< of flight.vehicles, from 0
  std::string name;         ///< what stands there
  std::size_t sortie = 0;   ///< of the vehicle, from 0
  std::string file;         ///< beside the timetable
  double start = 0.0;       ///< [s]
  double landing = 0.0;     ///< [s]
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
};

std::string timetable_csv(std::span<const TimetableRow> rows);

/// Throws Error{bad_file}, "FILE:LINE: what is wrong", for the first row that is no row, whose
/// vehicle is not the mission's, whose file is not beside it, or that stands there twice.
std::vector<TimetableRow> read_timetable(const std::filesystem::path& path,
                                         const flight::FlightOptions& options);

/// What the names of a vehicle's route files begin with: "fleet-1" for the first.
std::string stem_of(std::size_t vehicle);

/// The vehicle that a file of that name is for, counted from 0; nothing if it is for no fleet's.
std::optional<std::size_t> vehicle_of_file(std::string_view name);

/// Whether a file of that name is the timetable or one of a fleet's vehicles.
bool is_fleet_file(std::string_view name);

/// The flight of the vehicle that a route file is for, from the pad that the timetable beside the
/// file says; of other files the flight itself. Throws as read_timetable().
flight::FlightOptions flight_of_file(const std::filesystem::path& file,
                                     const flight::FlightOptions& options);

/// The format that an autopilot flies itself.
flight::Format own_format(flight::Dialect dialect);

}  // namespace skycap::missions::package
