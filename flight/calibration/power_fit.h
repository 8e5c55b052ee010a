/// Fits the power model of Motion to windows of a flight.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/calibration/flight_log.h"
#include "flight/motion/vehicle.h"

namespace skycap::flight {

/// Samples that follow each other, of nearly steady flight.
struct LogWindow {
  std::vector<Eigen::Vector3d> velocities;  ///< [m/s]
  double power = 0.0;                       ///< mean [W]
  double duration = 0.0;                    ///< [s]
};

/// The windows of steady flight, in the air.
std::vector<LogWindow> windows_of(const std::vector<LogSample>& samples);

struct PowerFit {
  Vehicle vehicle;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< [m/s]
};

/// Least squares of the windows' powers over endurance, avionics, drag area and wind, from the
/// vehicle's own figures on.
PowerFit fit_power(std::span<const LogWindow> windows, const Vehicle& vehicle, double air_density);

/// The model's mean power in a window [W].
double modelled_power(const PowerFit& fit, const LogWindow& window, double air_density);

}  // namespace skycap::flight
