/// Fit of Motion's power model to windows of a flight.
///
/// Steps: damaged single readings are skipped; consecutive samples of nearly steady flight form
/// windows; the unknowns are fitted to the power of the windows. The fit uses iteratively
/// reweighted least squares (Huber 1981, section 7.8) with Ceres.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/calibration/flight_log.h"
#include "flight/motion/vehicle.h"

namespace skycap::flight {

/// Returns the upper median. Requires at least one value.
double median(std::vector<double> values);

/// Consecutive samples of nearly steady flight.
struct LogWindow {
  std::vector<Eigen::Vector3d> velocities;  ///< Means of a few samples each [m/s].
  double power = 0.0;                       ///< Mean power [W].
  double duration = 0.0;                    ///< Duration [s].
};

/// Returns the samples without outliers. An outlier's power or velocity differs from all neighbours
/// within one second, because of damaged bytes. Times must ascend.
std::vector<LogSample> without_outliers(const std::vector<LogSample>& samples);

/// Returns the windows of steady flight in the air.
std::vector<LogWindow> find_windows(const std::vector<LogSample>& samples);

struct PowerFit {
  Vehicle vehicle;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< Wind velocity [m/s].
  std::vector<std::string> at_bound;  ///< Parameters that the fit limited to their bounds.
};

/// Fits endurance, avionics power, drag area and wind to the window powers. The initial values are
/// those of `vehicle` and `hover_power` [W], which must exceed min_rotor_power().
PowerFit fit_power(std::span<const LogWindow> windows, const Vehicle& vehicle, double air_density,
                   double hover_power);

/// Returns the mean power that the model predicts for a window [W].
double modelled_power(const PowerFit& fit, const LogWindow& window, double air_density);

}  // namespace skycap::flight
