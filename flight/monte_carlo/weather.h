/// Wind with gusts and navigation errors for simulated flights.
///
/// Gusts follow the Dryden model at low altitude (MIL-F-8785C, section 3.7.3.4). Each component is
/// a first-order process with the model's intensity and length scale, although the model's spectra
/// for the two cross components are of second order. Intensities follow from the mean wind.
#pragma once

#include <Eigen/Core>

#include "geometry/random_numbers.h"

namespace skycap::flight {

/// Air velocity above a site: east, north and up [m/s].
class Weather {
 public:
  /// Constructs steady wind plus gusts. `wind` is the air velocity [m/s].
  Weather(const Eigen::Vector2d& wind, geometry::RandomNumbers& random)
      : wind_(wind), random_(random) {}

  /// Returns the air velocity after a further `step` [s], at `height` above ground [m] and
  /// `airspeed` [m/s].
  Eigen::Vector3d next(double step, double height, double airspeed);

 private:
  Eigen::Vector2d wind_;
  geometry::RandomNumbers& random_;
  Eigen::Vector3d gust_ = Eigen::Vector3d::Zero();  ///< Along the wind, across, up [m/s].
  bool has_begun_ = false;
};

/// Navigation error: a first-order Gauss-Markov process per axis. The total error is limited to
/// `bound` [m], which equals three standard deviations.
class ReceiverError {
 public:
  ReceiverError(double bound, geometry::RandomNumbers& random) : bound_(bound), random_(random) {}

  Eigen::Vector3d next(double step);

 private:
  double bound_;
  geometry::RandomNumbers& random_;
  Eigen::Vector3d error_ = Eigen::Vector3d::Zero();
  bool has_begun_ = false;
};

}  // namespace skycap::flight
