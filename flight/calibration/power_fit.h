/// Fits the power model of Motion to windows of a flight.
///
/// Steps: single readings that damage has made are left out; samples that follow each other in
/// nearly steady flight become windows; the model's unknowns are fitted to the windows' powers by
/// iteratively reweighted least squares (Huber 1981, section 7.8) with Ceres.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/calibration/flight_log.h"
#include "flight/motion/vehicle.h"

namespace skycap::flight {

/// The upper median of at least one value.
double median(std::vector<double> values);

/// Samples that follow each other, of nearly steady flight.
struct LogWindow {
  std::vector<Eigen::Vector3d> velocities;  ///< means of a few samples each [m/s]
  double power = 0.0;                       ///< mean [W]
  double duration = 0.0;                    ///< [s]
};

/// The samples without those whose power or velocity no neighbour within a second shares: what
/// damaged bytes have made of single readings. Times must ascend.
std::vector<LogSample> without_outliers(const std::vector<LogSample>& samples);

/// The windows of steady flight, in the air.
std::vector<LogWindow> windows_of(const std::vector<LogSample>& samples);

struct PowerFit {
  Vehicle vehicle;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< [m/s]
  std::vector<std::string> at_bound;  ///< figures that the fit would set beyond what is possible
};

/// The windows' powers over endurance, avionics, drag area and wind, from the vehicle's own figures
/// on. `hover_power`, above min_rotor_power(), is where the fit begins [W].
PowerFit fit_power(std::span<const LogWindow> windows, const Vehicle& vehicle, double air_density,
                   double hover_power);

/// The model's mean power in a window [W].
double modelled_power(const PowerFit& fit, const LogWindow& window, double air_density);

}  // namespace skycap::flight
