/// A vehicle's figures from a log of its own flight.
///
/// Power: the model of Motion, with the endurance (which is the power of hovering), the avionics'
/// power, the drag area and the wind of that day as unknowns, is fitted to the log's battery
/// (power_fit.h) in windows of two seconds; windows in which the vehicle speeds up or brakes are
/// left out. How far the energy of a part of the flight that the fit has not seen is off becomes
/// the vehicle's energy_error. A log that the model does not fit is refused.
///
/// Minutes: the autopilot's parameters say its limits; what its legs took beyond its law is the
/// time to settle.
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
  Vehicle vehicle;                                 ///< with what the log says
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< of that flight, east and north [m/s]
  double flown = 0.0;                              ///< in the air [s]
  double hover_power = 0.0;                        ///< in still air at sea level [W]
  double scatter = 0.0;                            ///< of windows about the model, rms [W]
  double energy_error = 0.0;  ///< of parts that the fit has not seen, rms, as a share
  std::size_t windows = 0;
  std::size_t outliers = 0;           ///< readings that were left out as damaged
  std::vector<std::string> warnings;  ///< what the pilot must know of the fit
  std::size_t parameters = 0;         ///< of the autopilot that were taken over
  std::optional<double> settling;     ///< median of the legs, if there are enough [s]
  std::size_t legs = 0;               ///< that ended in a stop
  std::size_t legs_without_time = 0;  ///< that took less than any vehicle takes
};

/// What the log does not say stays as in `vehicle`, whose mass, rotors and battery must be those of
/// the flight. With `mass` the vehicle is another one of its kind, of that mass [kg]: if its rotors
/// could not carry it at the measured power, they are scaled to the same disc loading, with a
/// warning. Throws Error{bad_file} if no power was measured, if the log holds too little of
/// hovering or of level flight, saying which flight suffices, if the power is less than the mass
/// takes to hover, and if it scatters too far about the model.
Calibration calibrate(const FlightLog& log, const Vehicle& vehicle, double air_density,
                      std::optional<double> mass = {});

/// An energy_error is not set lower: batteries and air differ from day to day.
inline constexpr double least_energy_error = 0.05;

}  // namespace skycap::flight
