/// Vehicle parameters identified from a flight log.
///
/// Power: the model of Motion is fitted to the logged battery power in windows of two seconds
/// (power_fit.h). The unknowns are endurance (equivalent to hover power), avionics power, drag area
/// and the wind of that day. Windows with acceleration or braking are skipped. The energy error on
/// parts of the flight outside the fit becomes the vehicle's energy_error. A log that does not
/// match the model is rejected.
///
/// Time: the limits come from the autopilot's parameters. The excess of leg durations over the leg
/// law becomes the settle time.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/calibration/flight_log.h"
#include "flight/motion/vehicle.h"

namespace skycap::flight {

struct Calibration {
  Vehicle vehicle;  ///< Vehicle with the identified parameters.
  /// Wind velocity during the flight, east and north [m/s].
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();
  double flight_time = 0.0;   ///< Time in the air [s].
  double hover_power = 0.0;   ///< Hover power in still air at sea level [W].
  double scatter = 0.0;       ///< RMS deviation of windows from the model [W].
  double energy_error = 0.0;  ///< RMS relative energy error on parts outside the fit.
  std::size_t windows = 0;
  std::size_t outliers = 0;           ///< Number of readings skipped as damaged.
  std::vector<std::string> warnings;  ///< Warnings about the fit for the pilot.
  std::size_t parameters = 0;         ///< Number of autopilot parameters that were used.
  std::optional<double> settling;     ///< Median settle time of the legs, if there are enough [s].
  std::size_t legs = 0;               ///< Number of legs that ended in a stop.
  std::size_t legs_without_time = 0;  ///< Number of legs faster than physically possible.
};

/// Returns the calibration of `vehicle`, whose mass, rotors and battery must be those of the
/// flight. Values missing from the log remain unchanged. `mass` [kg] requests a vehicle of the same
/// type with that mass. If its rotors could not carry it at the measured power, they are scaled to
/// equal disc loading, with a warning.
///
/// Throws Error{bad_file} if the log lacks power values. Also throws it if the log has too little
/// hover or level flight, with the flight that would suffice. Other causes are power below the
/// minimum for hovering, and excessive scatter around the model.
Calibration calibrate(const FlightLog& log, const Vehicle& vehicle, double air_density,
                      std::optional<double> mass = {});

/// Minimum for energy_error, because batteries and air density vary from day to day.
inline constexpr double min_energy_error = 0.05;

}  // namespace skycap::flight
